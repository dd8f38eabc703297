// SPDX-License-Identifier: MIT
#pragma once
// The methods of a comparison and the ripple it looks at, from what was typed and the files it names.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/options.hpp"
#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

struct Field {
    std::vector<Contender> contenders;            ///< the control first, unless it was typed elsewhere
    std::shared_ptr<const CandidateTable> table;  ///< of the first method that needs one
};

struct LinesRequest {
    std::optional<double> gear_ratio;
    std::vector<double> orders;
    std::optional<std::string> joint_file;
};

/// Throws UsageError when `methods` is empty or one of them is wrong, and what load_table and
/// load_identification throw. `gear` fills what methods that follow the gear are not given.
[[nodiscard]] Field load_contenders(const std::vector<std::string>& methods, const LinesRequest& gear,
                                    Provenance& provenance);

/// Options first, then the joint file, then the table of a method, then a method that follows the gear. Empty
/// when nothing says where the ripple is; throws UsageError when only one of gear ratio and orders is known.
[[nodiscard]] std::optional<RippleLines> lines_of(const LinesRequest& request, const Field& field,
                                                  Provenance& provenance);

/// Warns when a method's table is for a slightly different rate, and throws DataError when it is for another.
void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common);

}  // namespace ripplenotch
