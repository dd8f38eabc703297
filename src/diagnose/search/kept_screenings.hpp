// SPDX-License-Identifier: MIT
#pragma once
// What was found beside a model along one case, so that it is not looked for again beside a model that leaves
// the same torque: a search comes back to the model that it began with, fitted from elsewhere or against
// another noise.

#include <deque>
#include <span>
#include <vector>

#include "diagnose/case/lines.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// A model by what a screening sees of it. What is kept of it lives no longer than what it points to.
struct SeenModel {
    const Model& open;                       ///< values to be fitted are empty
    const std::vector<double>& left_nm;      ///< measured less predicted, a number a sample
    std::span<const Effect* const> effects;  ///< that are tried
};

template <class Found>
class KeptBeside {
  public:
    /// What was found beside a model of the same terms whose torque differs by no more than `most_nm2`,
    /// summed over the samples that `use` counts; null where there is none.
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
    double gain = 0.0;  ///< of the whole log, foreseen, in units of the noise's variance
    double price = 0.0;
    [[nodiscard]] double score() const { return gain - price; }
};

/// The best trial of each effect, the best first, and the unit of their gains.
struct Screened {
    std::vector<Trial> trials;
    double unit_nm2 = 1.0;
    std::vector<double> color = {};  ///< of the noise that they were weighed by
};

/// The best gear ratios where the torque is late by what makes the most of them, and without.
struct LateRatio {
    double delay_s = 0.0;
    RatioCandidates ratios;
    double strongest_alone_nm2 = 0.0;
};

struct KeptScreenings {
    KeptBeside<Screened> screened;
    KeptBeside<LateRatio> late_ratios;
};

}  // namespace ripplenotch
