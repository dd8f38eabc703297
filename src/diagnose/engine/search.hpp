// SPDX-License-Identifier: MIT
#pragma once
// The one search: the best of a few refined candidates is added as long as it is admissible, needless terms
// are dropped, and each term is exchanged against every rival.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnose/engine/criterion.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch::engine {

/// What speaks for a longer model against a shorter one.
struct Admission {
    bool is_admissible = false;
    double reduction = 0.0;    ///< of the criterion
    double block_t = 0.0;      ///< mean reduction of a block over its standard error
    double noise_share = 0.0;  ///< rms torque explained, in units of the noise
    double gap_share = 0.0;    ///< of the squares still to be explained
    std::string reason;        ///< why not; empty where it is admissible
};

/// A set of terms with the criterion that they were chosen by: the noise is measured anew when a transform, a
/// ratio or a ripple is adopted.
struct SearchState {
    SearchedTerms terms;  ///< in order of adoption
    std::shared_ptr<Criterion> criterion;
};

struct RefusedTerm {
    SearchedTerm term;
    Admission admission;
};

struct SearchResult {
    SearchState best;
    std::vector<RefusedTerm> refused;  ///< the best candidates of the last step
};

class Search {
  public:
    /// `without`: names of effects that are not tried.
    Search(const RecordedMotion& recorded, const Baseline& base, std::shared_ptr<const SaturatedFit> noise,
           std::vector<std::string> without);

    [[nodiscard]] SearchResult run();

    /// The error of a velocity of which the positions are the integral, where the ripple shows one.
    [[nodiscard]] std::optional<SearchedTerm> velocity_bias(Criterion& criterion) const;
    /// Models with one more term, refined, best first.
    [[nodiscard]] std::vector<SearchedTerms> extensions(Criterion& criterion, const SearchedTerms& terms,
                                                        std::size_t finalists) const;
    [[nodiscard]] static Admission admission(Criterion& criterion, const SearchedTerms& shorter,
                                             const SearchedTerms& longer);

    /// A model and the term of it that another could stand for.
    struct Choice {
        const SearchedTerms& terms;
        const SearchedTerm& newest;
    };
    /// Of two models that say nearly the same, `one` is the plainer, or the rests speak for it.
    [[nodiscard]] bool is_preferred(Criterion& criterion, const SearchedTerms& fewer, const Choice& one,
                                    const Choice& other) const;

  private:
    struct Candidate {
        SearchedTerm term;
        double reduction = 0.0;
    };
    std::vector<SearchedTerm> starts(Criterion& criterion, const SearchedTerms& terms) const;
    [[nodiscard]] bool is_left_out(const TermKind& kind) const;
    [[nodiscard]] bool may_be_missing(const TermKind& kind, const SearchedTerms& terms) const;
    std::vector<SearchedTerm> begins(const TermKind& kind, const SearchedTerms& terms) const;
    [[nodiscard]] bool moves_both_ways_about(double time_s) const;
    void add_lines(Criterion& criterion, const SearchedTerms& terms, std::vector<SearchedTerm>& found) const;
    std::vector<Candidate> ranked(Criterion& criterion, const SearchedTerms& terms) const;
    SearchState path(SearchState state, std::vector<RefusedTerm>& refused) const;
    [[nodiscard]] std::optional<SearchedTerms> with_own_friction(Criterion& criterion,
                                                                 const SearchedTerms& terms,
                                                                 std::size_t shared) const;
    void exchange(SearchState& state, std::vector<SearchedTerms>& seen) const;
    [[nodiscard]] double squares_with_rests(const Criterion& criterion, const SearchedTerms& terms) const;
    [[nodiscard]] SearchState with_new_noise(const SearchState& state) const;

    const RecordedMotion& recorded_;
    const Baseline& base_;
    std::shared_ptr<const SaturatedFit> noise_;
    std::vector<std::string> without_;
};

/// True of every log and therefore corrected without being named: less than one and a half samples.
[[nodiscard]] bool is_below_resolution(const SearchedTerm& term, double step_s);

/// Error of a velocity whose integral puts the fastest ripple a quarter of a cycle off when the log ends.
[[nodiscard]] double bias_step_deg_s(const RecordedMotion& recorded, const Baseline& base);

/// Searches the values of one term, the others fixed.
[[nodiscard]] SearchedTerms refined(Criterion& criterion, SearchedTerms terms, std::size_t place);

// Values of adopted terms in the catalogue's parameters, with 95 % intervals.

struct ValuedTerm {
    Term term;
    std::vector<FittedValue> values;  ///< FittedValue::term is the term's place in the set
};

/// A term of the catalogue for each term of the set. Intervals are of a jackknife over
/// stretches of the log, of all linear values and the linearised others together, with the priors.
[[nodiscard]] std::vector<ValuedTerm> valued_terms(Criterion& criterion, const SearchedTerms& terms);

/// The intervals of its sizes hold those of no effect.
[[nodiscard]] bool may_be_absent(const ValuedTerm& valued);

/// The terms with their searched values at the minimum, which the search reaches to some per cent.
[[nodiscard]] SearchedTerms polished(Criterion& criterion, const SearchedTerms& terms);

/// The factor of a column of the baseline.
struct ValuedColumn {
    std::string name;
    double factor = 0.0, standard_error = 0.0;
};
/// Of every column of the baseline, in its order.
[[nodiscard]] std::vector<ValuedColumn> valued_columns(Criterion& criterion, const SearchedTerms& terms);

}  // namespace ripplenotch::engine
