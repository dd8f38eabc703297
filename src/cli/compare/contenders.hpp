// SPDX-License-Identifier: MIT
#pragma once
// The methods of a comparison and the ripple it looks at, from what was typed and the files it names.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/gear/chosen_method.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

struct Field {
    std::vector<Contender> contenders;            ///< the control first, unless it was typed elsewhere
    std::shared_ptr<const CandidateTable> table;  ///< of the first method that needs one
    /// Whose ripple all of them are measured by: that of the options and the joint file, else of the first
    /// method that follows the gear, else of the first table. Empty when nothing says where the ripple is.
    std::optional<GearAccount> gear;
};

/// The methods as they are on this log: at its temperature, where a map asks for one. The same without a log.
[[nodiscard]] std::vector<std::string> methods_at(const std::string& log, std::vector<std::string> methods,
                                                  const LogOptions& options);
/// By contender, the temperature that it follows at the rows that read_log_in_part gives; empty for others.
/// Says how many cells were none.
[[nodiscard]] std::vector<std::vector<double>> temperatures_for(std::span<const Contender> contenders,
                                                                const std::string& log,
                                                                const ReadOptions& read,
                                                                const CommonOptions& common);

/// Throws UsageError when `methods` is empty, and what choose_method and refuse_other_gear throw.
[[nodiscard]] Field load_contenders(const std::vector<std::string>& methods, const GearOptions& gear,
                                    Provenance& provenance);

/// Warns when a method's table is for a slightly different rate, and throws DataError when it is for another.
void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common);

}  // namespace ripplenotch
