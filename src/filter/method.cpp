// SPDX-License-Identifier: MIT
#include "filter/method.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

namespace {

constexpr const Method* list[] = {
#define METHOD(name) &filter_methods::name,
#include "filter/methods/methods.def"
#undef METHOD
};

}  // namespace

std::span<const Method* const> methods() { return {list, std::size(list)}; }

const Method& find_method(std::string_view name) { return find_entry(methods(), "method", "methods", name); }

}  // namespace ripplenotch
