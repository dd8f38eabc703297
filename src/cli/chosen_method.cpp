// SPDX-License-Identifier: MIT
#include "cli/chosen_method.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/joint_keys.hpp"
#include "ripplenotch/artifact/table.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

ChosenMethod choose_method(const std::string& spec_text, const std::optional<std::string>& table,
                           const GearOptions& gear) {
    Spec spec = parse_spec(spec_text);
    ChosenMethod chosen;
    chosen.method = &find_method(spec.name);
    const auto named = std::find_if(spec.values.begin(), spec.values.end(),
                                    [](const auto& entry) { return entry.first == "table"; });
    if (table) {
        if (!chosen.method->needs_table) {
            raise<UsageError>("--table is for methods that switch between bands; method {} has no table",
                              spec.name);
        }
        if (named != spec.values.end())
            raise<UsageError>("--table and table=... in --method: give one of them");
        spec.values.insert(spec.values.begin(), {"table", *table});
    }
    fill_from_options(spec, *chosen.method, gear);
    chosen.joint_path = spell_out_joint(spec, *chosen.method);
    const std::string what = fmt::format("method {}", spec.name);
    chosen.settings.emplace(what, spec, chosen.method->keys);
    chosen.text = spec.text();
    if (chosen.method->needs_table) {
        chosen.table_path = chosen.settings->text("table");
        chosen.table = std::make_shared<const CandidateTable>(load_table(chosen.table_path));
    }
    return chosen;
}

}  // namespace ripplenotch
