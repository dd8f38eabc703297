// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/beside.hpp"

#include <algorithm>
#include <memory>

#include "diagnose/beside/finding/look.hpp"
#include "diagnose/beside/finding/sensing.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/hearing.hpp"

namespace ripplenotch {
namespace {

class SensorSearch {
  public:
    SensorSearch(const GivenCase& log, const GivenCase* validation, const Candidate& model,
                 std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work)
        : log_(log), validation_(validation), model_(model), effects_(effects), rules_(rules), work_(work) {}

    [[nodiscard]] BesideOutcome run() const {
        std::unique_ptr<Look> plain = look(model_);
        std::optional<Finding> doubted;
        if (is_arm_alone(log_.given)) {
            const Unsensed unsensed{log_.given, model_, plain->sums, plain->named.now.names};
            std::optional<Term> sensor = suspected_sensor(unsensed, effects_, catalogue().size());
            // The other effect of the sensor takes its place once, where it is clearly ahead.
            for (int turn = 0; sensor && turn < 2; ++turn) {
                Candidate with = with_sensor(model_, *sensor);
                const std::unique_ptr<Look> behind = look(with);
                SensorVerdict verdict = judged_sensor(
                    unsensed, {*sensor, behind->sums, behind->named.now.names}, effects_, catalogue().size());
                if (turn == 0 && verdict.ahead) {
                    sensor = verdict.ahead;
                    continue;
                }
                look_at_other(verdict.finding, *plain, *behind, with);
                if (!is_doubtful(verdict.finding)) {
                    plain.reset();  // an arm's columns are large
                    BesideOutcome outcome = outcome_of(*behind, log_, with, effects_);
                    outcome.sensor = std::move(verdict.finding);
                    return outcome;
                }
                doubted = std::move(verdict.finding);
                break;
            }
        }
        BesideOutcome outcome = outcome_of(*plain, log_, model_, effects_);
        if (doubted) outcome.findings.push_back(std::move(*doubted));
        return outcome;
    }

  private:
    [[nodiscard]] std::unique_ptr<Look> look(const Candidate& model) const {
        auto found = std::make_unique<Look>(log_, validation_, model, effects_, rules_, work_);
        if (log_.given.empty() || !names_load(*found)) return found;
        // The load was fitted without the friction that it brings: once more with it.
        Case loaded = log_.looked_at;
        loaded.motion.known_nm = carried_beside(*found, model);
        return std::make_unique<Look>(GivenCase{loaded, log_.given}, validation_, model, effects_, rules_,
                                      work_);
    }

    static bool names_load(const Look& look) {
        return std::any_of(
            look.named.findings.begin(), look.named.findings.end(), [](const BesideFinding& finding) {
                return finding.status != FindingStatus::tentative && finding.shape.term.effect->uses_load;
            });
    }

    void look_at_other(Finding& finding, Look& plain, Look& behind, const Candidate& with) const {
        if (validation_ == nullptr) return;
        const double before_nm = left_of_other(plain.sums, model_, *validation_, plain.named.findings),
                     after_nm = left_of_other(behind.sums, with, *validation_, behind.named.findings);
        finding.validation_before_nm = before_nm;
        finding.validation_after_nm = after_nm;
        const double left = after_nm / before_nm;
        const bool against = Hearing(rules_, finding.decisions)
                                 .asked("reproduction.most_left", left, left > rules_.reproduction.most_left);
        if (!against || is_doubtful(finding)) return;
        finding.status = FindingStatus::not_reproduced;
        finding.reason = not_reproduced_words(before_nm, after_nm);
    }

    const GivenCase& log_;
    const GivenCase* validation_;
    const Candidate& model_;
    std::span<const Effect* const> effects_;
    const DiagnosisRules& rules_;
    Work& work_;
};

}  // namespace

BesideOutcome find_beside(const GivenCase& log, const GivenCase* validation, const Candidate& model,
                          std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work) {
    return SensorSearch(log, validation, model, effects, rules, work).run();
}

}  // namespace ripplenotch
