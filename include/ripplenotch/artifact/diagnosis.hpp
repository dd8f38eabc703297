// SPDX-License-Identifier: MIT
#pragma once
// diagnosis.json: what a diagnosis found, docs/formats/diagnosis.md.

#include <string>

#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Schema ripplenotch/diagnosis/1.
[[nodiscard]] std::string write_diagnosis(const Diagnosis& diagnosis, const Provenance& provenance);

}  // namespace ripplenotch
