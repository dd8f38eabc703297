// SPDX-License-Identifier: MIT
#pragma once
// metrics.json: what a filter did to one log.

#include <string>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"

namespace ripplenotch {

/// The whole text of metrics.json, schema ripplenotch/metrics/1; same metrics, same bytes.
[[nodiscard]] std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance);

}  // namespace ripplenotch
