// SPDX-License-Identifier: MIT
#pragma once
// A log that nothing was fitted to, beside which each finding has to leave no more than without it.

#include <string>
#include <vector>

#include "diagnose/beside/finding/beside.hpp"
#include "diagnose/beside/finding/sizes.hpp"
#include "diagnose/beside/naming/conditions.hpp"

namespace ripplenotch {

/// What is believed, with its values; `place` among the findings.
struct Believed {
    std::vector<std::size_t> place;
    std::vector<BesideValues> values;
};

/// Findings that are believed as they stand now.
[[nodiscard]] Believed believed_of(Sums& sums, const std::vector<BesideFinding>& findings);

/// rms that is left of the other log with and without each finding, in the order of the findings; 0 for those
/// that are in doubt.
struct OtherLeft {
    double without_nm = 0.0, with_nm = 0.0;
};

/// Withdraws, one after the other, what leaves more of the other log than is left without it.
std::vector<OtherLeft> withdraw_on_other(Sums& sums, const Candidate& model, const GivenCase& other,
                                         std::vector<BesideFinding>& findings);

/// Puts in doubt what is believed and may be nothing: the interval of its size holds 0. The widest first; the
/// others are looked at again without it. Another log that is left with less tells no size: what is confirmed
/// is asked with it, too, and a side of a tie (`of_ties_too`) without it. A ripple of which the ringing part
/// may be nothing is asked once more as one line.
void withdraw_what_may_be_nothing(Sums& sums, bool of_ties_too, std::vector<BesideFinding>& findings);

/// rms that is left of the other log with all that is believed of the findings.
[[nodiscard]] double left_of_other(Sums& sums, const Candidate& model, const GivenCase& other,
                                   const std::vector<BesideFinding>& findings);
/// Why a finding is not reproduced.
[[nodiscard]] std::string not_reproduced_words(double without_nm, double with_nm);

}  // namespace ripplenotch
