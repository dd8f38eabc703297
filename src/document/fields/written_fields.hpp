// SPDX-License-Identifier: MIT
#pragma once
// What was written beside a diagnosis, as its fields.

#include "document/json/json.hpp"
#include "ripplenotch/document/diagnosis_json.hpp"

namespace ripplenotch {

/// "mjcf" and "plan", where they were asked for.
void put_written(Json& json, const DiagnosisWritten& written);

}  // namespace ripplenotch
