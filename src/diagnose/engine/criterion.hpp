// SPDX-License-Identifier: MIT
#pragma once
// The one criterion: squares of the whitened residual in units of the noise, plus a penalty per fitted
// number. Linear values are solved exactly in every evaluation; products of columns are kept by block of the
// log, so that leaving blocks out costs next to nothing.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "diagnose/engine/baseline.hpp"
#include "diagnose/engine/saturated_fit.hpp"
#include "diagnose/engine/terms.hpp"

namespace ripplenotch::engine {

// Every number by which the engine decides, each with its reason. Grids and bounds of single values are with
// their terms (terms.cpp).

/// Penalty of one fitted number, in squares of the whitened noise: twice log(rows) / 2 of 40,000 rows, as of
/// the Bayesian information criterion. Logs are decided alike from 6 to 20.
inline constexpr double penalty_per_value = 10.0;
/// Reduction beyond the penalty that a term needs, by which one model is better than another, and within
/// which two are equally good: odds of 400 to 1, as 2 log(odds).
inline constexpr double least_reduction = 12.0;
/// Mean reduction of a block over its standard error: one stretch of the log must not decide.
inline constexpr double least_block_t = 4.0;
/// rms torque of a term in units of the noise, below which it is there and does not matter.
inline constexpr double least_noise_share = 0.3;
/// Share of the squares still to be explained that a term must take: else it corrects the form of another.
inline constexpr double least_gap_share = 0.1;
/// Share of the first gap that a change of the ripple must take: the form of a large resonance is not exact.
inline constexpr double least_whole_share = 0.01;
/// Share of the whole gap above which a term is accepted although few blocks carry it, as those of a drift
/// do.
inline constexpr double dominant_gap_share = 0.4;
/// A plainer term is preferred if it reaches this share of the other's reduction.
inline constexpr double plain_delay_share = 0.985;
inline constexpr double plain_friction_share = 0.96;
inline constexpr double plain_ratio_share = 0.99;

/// Squares over those of the noise from which paths that begin with other terms compete.
inline constexpr double much_left = 1.5;
/// Part of the blocks, the best, without which a term of few stretches is judged; what it must reduce there;
/// and, per sample, what a friction with another must, and Stribeck friction, the usual correction of a
/// form.
inline constexpr double best_block_share = 0.15;
inline constexpr double least_spread = 100.0;
inline constexpr double form_spread = 0.015, stribeck_spread = 0.1;

/// The samples that count, in blocks.
struct Blocks {
    std::vector<std::size_t> sample;  ///< slots, ascending
    std::vector<std::size_t> first;   ///< of each block in `sample`; one more for the end
    [[nodiscard]] std::size_t count() const { return first.size() - 1; }
};

/// Columns behind one filter, and their products by block. A column is computed once and its products stay.
class ColumnProducts {
  public:
    ColumnProducts(const Blocks& blocks, std::vector<double> filter, double unit_nm);

    using Make = std::function<std::vector<std::vector<double>>()>;
    struct Key {
        SearchedTerm term;  ///< kind null: a group of the baseline
        int group = 0;      ///< which, or another use of the term's columns
        double ratio = 0.0;
        SearchedTerms errors, transforms;
        auto operator<=>(const Key& other) const {
            return std::tie(group, term.kind, term.values, ratio, errors, transforms) <=>
                   std::tie(other.group, other.term.kind, other.term.values, other.ratio, other.errors,
                            other.transforms);
        }
        bool operator==(const Key&) const = default;
    };
    /// Places of the columns of a key; `make` yields them, unfiltered and whole, when they are new.
    const std::vector<int>& places(const Key& key, const Make& make);
    /// Products of two columns, a sum per block.
    std::span<const double> products(int a, int b);
    [[nodiscard]] std::span<const double> column(int place);

  private:
    void pack(int place, std::vector<double> whole);
    void release_old();

    const Blocks& blocks_;
    std::vector<double> filter_;
    double unit_nm_;
    std::map<Key, std::vector<int>> places_;
    struct Kept {
        std::vector<double> values;  ///< by Blocks::sample; empty once released
        Make make;
        std::size_t of_group = 0;
        std::uint64_t last_use = 0;
    };
    std::vector<Kept> columns_;
    std::size_t held_ = 0;
    std::uint64_t uses_ = 0;
    std::unordered_map<std::uint64_t, std::size_t> sums_place_;
    std::vector<double> sums_;
};

/// A set of terms fitted by linear least squares.
struct LinearFit {
    bool is_physical = true;  ///< false: a friction would drive the joint
    double squares = 0.0;     ///< of the residual, and of the priors' departures
    Eigen::VectorXd factors;  ///< of Design::columns
};

/// Stretches of the log that are left out in turn where a size is judged: longer than what an error of the
/// model correlates over, and many enough for Student's t to be near the normal distribution.
inline constexpr std::size_t most_stretches = 20;

struct BlockSquares {
    std::vector<double> fitted, held_out;  ///< of each block, with it and without it in the fit
    /// A column per stretch of the log: the factors without it, in units of their columns' rms.
    Eigen::MatrixXd without_stretch;
};

/// Which columns a set of terms has.
struct Design {
    std::vector<int> columns;
    std::vector<double> deviation;           ///< of each column's prior; infinity: none
    std::vector<std::size_t> first_of_term;  ///< place in `columns`, per term; of transforms the next term's
    int target = 0;
};

class Criterion {
  public:
    Criterion(const RecordedMotion& recorded, const Baseline& base,
              std::shared_ptr<const SaturatedFit> noise);

    [[nodiscard]] const LinearFit& fit(const SearchedTerms& terms);
    [[nodiscard]] const BlockSquares& block_squares(const SearchedTerms& terms);
    /// Size of a term's columns over its standard error, by leaving stretches out; 0 of a transform.
    [[nodiscard]] double size_t_value(const SearchedTerms& terms, const SearchedTerm& term);
    /// Squares of the fit and the penalty of its numbers.
    [[nodiscard]] double cost(const SearchedTerms& terms);

    /// Squares of the residual in Nm^2 without nuisance columns, by block.
    [[nodiscard]] const std::vector<double>& plain_block_squares(const SearchedTerms& terms);
    /// Residual in Nm, 0 where samples do not count; without ripple, or without what changes it, on demand.
    enum class Ripple { fitted, left };
    [[nodiscard]] std::vector<double> residual_nm(const SearchedTerms& terms, Ripple ripple = Ripple::fitted);
    /// Factors of the columns, those of the baseline with a prior from the residual itself instead of what is
    /// white of it, the others as they are.
    [[nodiscard]] Eigen::VectorXd settled_factors(const SearchedTerms& terms);
    /// rms of residual_nm over the samples that count.
    [[nodiscard]] double rms_nm(const SearchedTerms& terms);

    [[nodiscard]] const RecordedMotion& recorded() const { return recorded_; }
    [[nodiscard]] const Baseline& base() const { return base_; }
    [[nodiscard]] const SaturatedFit& noise() const { return *noise_; }
    [[nodiscard]] const Blocks& blocks() const { return blocks_; }
    [[nodiscard]] double samples() const { return static_cast<double>(blocks_.sample.size()); }

    /// Columns of the design along the whitened samples, for intervals.
    [[nodiscard]] Design design(const SearchedTerms& terms) { return design(terms, white_, {}); }
    [[nodiscard]] ColumnProducts& white() { return white_; }

  private:
    struct Parts {
        bool nuisance = true;
        Ripple ripple = Ripple::fitted;
    };
    [[nodiscard]] bool is_possible(const SearchedTerms& terms) const;
    Design design(const SearchedTerms& terms, ColumnProducts& columns, const Parts& parts);
    std::vector<std::vector<double>> term_columns(const SearchedTerm& term, const MotorAngle& angle) const;
    std::vector<std::vector<double>> ripple_waves(const MotorAngle& angle) const;
    Eigen::MatrixXd gram(const Design& design, ColumnProducts& columns, std::vector<Eigen::MatrixXd>* blocks);
    [[nodiscard]] std::vector<double> prior_weights(const Design& design, const Eigen::MatrixXd& gram,
                                                    double noise_nm) const;

    const RecordedMotion& recorded_;
    const Baseline& base_;
    std::shared_ptr<const SaturatedFit> noise_;
    Blocks blocks_;
    ColumnProducts white_, plain_;
    std::map<SearchedTerms, LinearFit> fits_;
    std::map<SearchedTerms, BlockSquares> block_squares_;
    std::map<SearchedTerms, std::vector<double>> plain_squares_;
};

}  // namespace ripplenotch::engine
