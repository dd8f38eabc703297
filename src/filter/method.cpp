// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/method.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "filter/methods/list.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {
constexpr const Method* list[] = {
#define METHOD(name) &filter_methods::name,
#include "filter/methods/methods.def"
#undef METHOD
};
}  // namespace

std::span<const Method* const> methods() { return {list, std::size(list)}; }

const Method& find_method(std::string_view name) {
    std::vector<std::string> known;
    for (const Method* method : methods()) {
        if (method->name == name) return *method;
        known.emplace_back(method->name);
    }
    const auto near = nearest_name(name, known);
    raise<UsageError>("there is no method '{}'{}; methods: {}", name,
                      near ? fmt::format(" (did you mean {}?)", *near) : "", fmt::join(known, ", "));
}

}  // namespace ripplenotch
