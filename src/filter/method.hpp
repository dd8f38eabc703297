// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch::filter_methods {

#define METHOD(name) extern const Method name;
#include "filter/methods/methods.def"
#undef METHOD

}  // namespace ripplenotch::filter_methods
