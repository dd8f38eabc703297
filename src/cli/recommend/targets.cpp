// SPDX-License-Identifier: MIT
#include "cli/recommend/targets.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/options/name_list.hpp"
#include "cli/options/shell_word.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/export/method_code.hpp"

namespace ripplenotch {
namespace {

template <class Entries>
auto named(const Entries& entries, const std::string& name) -> decltype(*entries.begin()) {
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const auto* entry) { return entry->name == name; });
    static constexpr typename std::iterator_traits<decltype(entries.begin())>::value_type none = nullptr;
    return found == entries.end() ? none : *found;
}

}  // namespace

TargetChoice find_any_target(const std::string& text) {
    TargetChoice choice{parse_spec(text), nullptr, nullptr};
    choice.filters = named(export_targets(), choice.spec.name);
    choice.maps = named(map_targets(), choice.spec.name);
    if (choice.filters == nullptr && choice.maps == nullptr) {
        raise<UsageError>("--target {}: there is none of this name; of filters {}; of maps {}",
                          choice.spec.name, name_list(export_targets()), name_list(map_targets()));
    }
    return choice;
}

bool TargetChoice::holds(const Contender& method) const {
    if (method.method->name == "map") return maps != nullptr;
    if (filters == nullptr) return false;
    if (method.method->needs_table) return filters->switches;
    if (method.method->steady == nullptr) return is_code_target(spec.name) && has_code(method.method->name);
    return !filters->notches_only ||
           std::holds_alternative<std::vector<NotchSpec>>(method.method->steady(method.settings));
}

std::optional<RippleMap> TargetChoice::held(const RippleMap& map) const {
    if (maps == nullptr || map.orders.empty()) return std::nullopt;
    const Settings settings(fmt::format("target {}", spec.name), spec, maps->keys);
    const RippleMap kept = maps->read(maps->write(map, settings, {}).bytes, "the target", map, settings).held;
    if (kept.form.columns() == map.form.columns()) return std::nullopt;
    return kept;
}

std::string TargetChoice::command(const Contender& method, Hertz sample_rate) const {
    const bool is_map = method.method->name == "map";
    const std::string_view endings = is_map ? maps->endings : filters->endings;
    const std::string file = "ripple" + std::string(endings.substr(0, endings.find(' ')));
    const std::string from = is_map || method.method->needs_table
                                 ? (method.files.empty() ? "map.json" : method.files.front())
                                 : fmt::format("--method {} --sample-rate {}Hz", shell_quoted(method.text),
                                               shortest(sample_rate.value()));
    return fmt::format("ripplenotch export {} --to {} -o {} --verify", from, shell_quoted(spec.text()), file);
}

}  // namespace ripplenotch
