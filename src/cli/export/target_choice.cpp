// SPDX-License-Identifier: MIT
#include "cli/export/target_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

Settings settings_of(const Spec& spec, std::span<const Key> keys) {
    return {fmt::format("target {}", spec.name), spec, keys};
}

namespace {

template <class Entries>
auto named(const Entries& entries, const std::string& name) -> decltype(*entries.begin()) {
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const auto* entry) { return entry->name == name; });
    static constexpr typename std::iterator_traits<decltype(entries.begin())>::value_type none = nullptr;
    return found == entries.end() ? none : *found;
}

bool is_written_from_file(const Contender& method) {
    return method.method->is_map || method.method->needs_table;
}

}  // namespace

FilterSet filters_of(const Contender& method, const std::optional<Hertz>& sample_rate) {
    if (method.table != nullptr) {
        const Hertz rate = method.table->spec().sample_rate;
        return filter_set(*method.table, switching_design(method.settings, rate, *method.table));
    }
    return std::visit([&](const auto& design) { return filter_set(design, *sample_rate); },
                      method.method->steady(method.settings));
}

// Written as export would write it, so that the command that is printed runs.
std::string TargetChoice::refusal(const Contender& method, Hertz sample_rate) const {
    const Method& of = *method.method;
    if (of.is_map ? maps == nullptr : filters == nullptr)
        return fmt::format("it takes no {}", of.is_map ? "maps" : "filters");
    try {
        if (of.is_map) {
            const RippleMap map = method.map != nullptr ? *method.map : RippleMap{};
            if (method.map != nullptr) static_cast<void>(maps->write(map, settings_of(spec, maps->keys), {}));
        } else if (of.running != nullptr) {
            if (!is_code_target(spec.name)) return "its coefficients change while it runs";
            static_cast<void>(write_method_code(of.running(method.settings, sample_rate),
                                                settings_of(spec, method_code_keys()), {}));
        } else if (method.table == nullptr && of.steady == nullptr) {
            return "it has no coefficients";
        } else if (method.table != nullptr && !filters->switches) {
            return "it holds no bands";
        } else {
            static_cast<void>(
                filters->write(filters_of(method, sample_rate), settings_of(spec, filters->keys), {}));
        }
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

std::optional<RippleMap> TargetChoice::held(const RippleMap& map) const {
    if (maps == nullptr || map.orders.empty()) return std::nullopt;
    try {
        const Settings settings = settings_of(spec, maps->keys);
        const RippleMap kept =
            maps->read(maps->write(map, settings, {}).bytes, "the target", map, settings).held;
        if (kept.form.columns() != map.form.columns()) return kept;
    } catch (const UsageError&) {
        // refusal() has the reason.
    }
    return std::nullopt;
}

std::string TargetChoice::command(const Contender& method, Hertz sample_rate) const {
    const std::string_view endings = method.method->is_map ? maps->endings : filters->endings;
    const std::string file = "ripple" + std::string(endings.substr(0, endings.find(' ')));
    const std::string from = is_written_from_file(method)
                                 ? (method.files.empty() ? "map.json" : method.files.front())
                                 : fmt::format("--method {} --sample-rate {}Hz", shell_quoted(method.text),
                                               shortest(sample_rate.value()));
    return fmt::format("ripplenotch export {} --to {} -o {}", from, shell_quoted(spec.text()), file);
}

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

}  // namespace ripplenotch
