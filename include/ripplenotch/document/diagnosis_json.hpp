// SPDX-License-Identifier: MIT
#pragma once
// diagnosis.json: what a diagnosis found, docs/formats/diagnosis.md.

#include <string>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// Schema ripplenotch/diagnosis/1. `gear` is that of the model as given.
[[nodiscard]] std::string write_diagnosis(const Diagnosis& diagnosis, const GearAccount& gear,
                                          const Provenance& provenance);

}  // namespace ripplenotch
