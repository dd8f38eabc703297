// SPDX-License-Identifier: MIT
#pragma once

#include "log/messages/field_tree.hpp"

namespace ripplenotch {

/// Messages in JSON, an object each. Whether a schema says more about them makes no difference: numbers say
/// that they are.
[[nodiscard]] std::shared_ptr<const FieldWalk> json_walk();

}  // namespace ripplenotch
