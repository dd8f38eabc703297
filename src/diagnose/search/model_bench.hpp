// SPDX-License-Identifier: MIT
#pragma once
// A case with its noise, on which models are fitted and compared.

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/case/noise_floor.hpp"
#include "model/carriers.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// The budget of a search, counted and not timed, so that the same log ends at the same point everywhere.

/// How often effects were run along a motion; the unit is unit_samples.
class Work {
  public:
    explicit Work(double most) : most_(most) {}

    /// Samples that one evaluation runs along.
    static constexpr double unit_samples = 40'000.0;

    void add(std::size_t applied, std::size_t samples) {
        spent_ += static_cast<double>(applied) * static_cast<double>(samples) / unit_samples;
    }
    [[nodiscard]] double spent() const { return spent_; }
    /// Whether a search has to end here; remembered.
    [[nodiscard]] bool is_over() { return ended_ = ended_ || spent_ > most_; }
    [[nodiscard]] bool ended() const { return ended_; }

  private:
    double most_, spent_ = 0.0;
    bool ended_ = false;
};

// Projections of a column of samples on others: orthogonal bases, and the square of a projection.

/// One number a sample.
using Column = std::vector<double>;

/// Sum of products of two columns of the same length.
[[nodiscard]] double product(const Column& a, const Column& b);

/// Orthonormal columns that span the same space as `columns`, the first column first; a column that is a
/// combination of those before it, to a part in ten million, is left out.
[[nodiscard]] std::vector<Column> orthonormal(std::span<const Column> columns);

/// The part of a column outside the basis, whose columns are orthonormal().
[[nodiscard]] Column outside_of(std::span<const Column> basis, Column column);

/// Square of the projection of `left` on the basis and the columns together, in its unit squared: as by
/// orthonormal() of all of them, but from their products alone, which takes a third of the time. A column is
/// left out where it is a combination of the others to a part in a hundred thousand: products have no higher
/// accuracy.
[[nodiscard]] double explained(std::span<const Column> basis, std::span<const Column> columns,
                               const Column& left);

// Results for a model along one case, kept so that they are not computed again for a model with the same
// residual: a search returns to the model that it began with, fitted from elsewhere or against another noise.

/// A model as a screening uses it. It must not outlive the objects that it refers to.
struct SeenModel {
    const Model& open;                       ///< values to be fitted are empty
    const std::vector<double>& left_nm;      ///< measured less predicted, a number a sample
    std::span<const Effect* const> effects;  ///< the effects tried
};

template <class Found>
class KeptBeside {
  public:
    /// The result for a model of the same terms whose torque differs by no more than `most_nm2`, summed over
    /// the samples that `use` counts; null where there is none.
    [[nodiscard]] const Found* find(const SeenModel& model, std::span<const unsigned char> use,
                                    double most_nm2) const {
        for (const Entry& entry : entries_) {
            if (entry.open != model.open || !std::ranges::equal(entry.effects, model.effects)) continue;
            double squares = 0.0;
            for (std::size_t k = 0; k < entry.left_nm.size(); ++k) {
                const double difference = use[k] != 0 ? entry.left_nm[k] - model.left_nm[k] : 0.0;
                squares += difference * difference;
            }
            if (squares <= most_nm2) return &entry.found;
        }
        return nullptr;
    }

    /// The oldest gives way.
    const Found& keep(const SeenModel& model, Found found) {
        if (entries_.size() == most_kept) entries_.pop_front();
        entries_.push_back(
            {model.open, model.left_nm, {model.effects.begin(), model.effects.end()}, std::move(found)});
        return entries_.back().found;
    }

  private:
    // A model of a few names is compared with those without one of them.
    static constexpr std::size_t most_kept = 8;

    struct Entry {
        Model open;
        std::vector<double> left_nm;
        std::vector<const Effect*> effects;
        Found found;
    };
    std::deque<Entry> entries_;
};

struct Trial {
    Term open;          ///< values to be fitted are empty
    Term start;         ///< with the place to begin at
    double gain = 0.0;  ///< predicted for the whole log, in units of the noise's variance
    double price = 0.0;
    [[nodiscard]] double score() const { return gain - price; }
};

/// The best trial of each effect, the best first, and the unit of their gains.
struct Screened {
    std::vector<Trial> trials;
    double unit_nm2 = 1.0;
    std::vector<double> color = {};  ///< colour of the noise that weighted them
};

/// The best gear ratios with the torque delay that makes the most of them, and without.
struct LateRatio {
    double delay_s = 0.0;
    RatioCandidates ratios;
    double strongest_alone_nm2 = 0.0;
};

struct KeptScreenings {
    KeptBeside<Screened> screened;
    KeptBeside<LateRatio> late_ratios;
};

/// Share of the noise floor below which a torque does not matter. Steps coarser than the noise bend whatever
/// is in the torque into shapes of their own, which are no effects.
[[nodiscard]] double material_sigma(const Case& looked_at);

/// A model in hand: the terms of the user's model first, then those that were added.
struct Candidate {
    Model open;    ///< values to be fitted are empty
    Model stated;  ///< with them
    std::vector<FittedValue> values;
    std::vector<double> prices;  ///< one a term; 0 for the user's own
    double gain_left = 0.0;      ///< sum of squares in units of the noise's variance
    bool converged = true;

    [[nodiscard]] double criterion() const;
};

class KnownFit;

class ModelBench {
  public:
    /// `looked_at` and `work` must outlive it. `kept`: of other benches on the same case.
    ModelBench(const Case& looked_at, const NoiseFloor& noise, Work& work,
               std::shared_ptr<KeptScreenings> kept = std::make_shared<KeptScreenings>());

    /// Takes up the motion errors of this model: what can be blamed on them is no gap.
    void settle_on(const Model& model);

    [[nodiscard]] Candidate fitted(const Model& open, const Model& first_guess, std::vector<double> prices,
                                   int most_iterations = 8, double settled = 1e-7) const;
    /// The same model with the errors of its values, which a search does not need.
    [[nodiscard]] Candidate with_errors(Candidate model) const;
    /// The same model at its very best, with errors that do not take the noise for white.
    [[nodiscard]] Candidate settled(const Candidate& model) const;
    /// Weighed measured less predicted torque, in units of the noise, a number per row().
    [[nodiscard]] std::vector<double> residual(const Model& stated) const;
    /// Measured less predicted torque, with the best values of the uncertain known torque.
    [[nodiscard]] std::vector<double> raw_residual(const Model& stated) const;
    /// A torque whitened, in units of the noise, a number per row().
    [[nodiscard]] std::vector<double> whitened(std::span<const double> torque_nm) const;
    /// The same without what errors of the measured motion can explain; an entry per row().
    [[nodiscard]] std::vector<double> cleared_residual(const Model& stated) const;
    /// The torque of this term of the model in addition to all its others, in Nm; an entry per sample,
    /// counted or not.
    [[nodiscard]] std::vector<double> torque_of(const Model& stated, std::size_t term) const;

    /// rms torque that `with` explains beyond `without`, in units of the noise's rms.
    [[nodiscard]] double share(const Candidate& with, const Candidate& without) const;
    /// rms of the residual that the noise and the errors of the measured motion leave.
    [[nodiscard]] double floor_nm(const Model& stated) const;

    [[nodiscard]] const Case& looked_at() const { return case_; }
    /// Share of the noise floor below which a torque does not matter in `looked_at`.
    [[nodiscard]] double material_sigma() const { return ripplenotch::material_sigma(case_); }
    [[nodiscard]] Work& work() const { return work_; }
    /// Whether what no effect explains is part of the noise.
    [[nodiscard]] bool noise_holds_residual() const { return noise_.material_nm < noise_.rms_nm; }
    [[nodiscard]] const NoiseFloor& noise() const { return noise_; }
    [[nodiscard]] const std::vector<std::size_t>& rows() const { return weighing_.rows(); }
    [[nodiscard]] double samples() const { return static_cast<double>(weighing_.rows().size()); }

    /// Results of screenings along this case, whichever bench they were made on.
    [[nodiscard]] const std::shared_ptr<KeptScreenings>& kept() const { return kept_; }
    /// Sum of squares by which two models may differ for the results of one to hold for the other.
    [[nodiscard]] double same_model_nm2() const;

  private:
    [[nodiscard]] Candidate fitted(const Model& open, std::vector<double> prices,
                                   const FitOptions& options) const;
    /// The weighing of a model whose sensors are not those that were settled on.
    struct OwnWeighing {
        std::vector<Term> beside;  ///< the sensors
        std::optional<Weighing> other;
    };
    [[nodiscard]] OwnWeighing weighing_of(const Model& model) const;
    [[nodiscard]] std::vector<Nuisance> errors_of(const Model& model) const;

    mutable Carriers carriers_;
    const Case& case_;
    NoiseFloor noise_;
    Work& work_;
    Weighing weighing_;
    bool is_settled_ = false;
    std::vector<Term> sensors_;    ///< sensors of the settled model
    std::vector<Nuisance> walks_;  ///< errors from the random walk of its angle
    double walks_beside_nm_ = 1.0;
    std::shared_ptr<KeptScreenings> kept_;
    std::shared_ptr<const KnownFit> known_;  ///< behind the sensors of the model settled on
};

}  // namespace ripplenotch
