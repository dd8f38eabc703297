// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/other_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/vectors/dot.hpp"
#include "diagnose/search/hearing.hpp"
#include "diagnose/telling/summary.hpp"

namespace ripplenotch {
namespace {

bool is_in_doubt(FindingStatus status) {
    return status == FindingStatus::tentative || status == FindingStatus::not_reproduced;
}

std::vector<double> torque_of_other(const std::vector<BesideValues>& values, const Model& beside,
                                    const Motion& motion, std::optional<std::size_t> but) {
    std::vector<double> sum(motion.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (but && *but == i) continue;
        const std::vector<double> torque_nm = torque_of(values[i], beside, motion);
        add_scaled(1.0, torque_nm.data(), sum.data(), sum.size());
    }
    return sum;
}

// By how much of itself the interval of a size reaches over 0; 0 where it does not.
double reach_beyond_0(const BesideValues& values) {
    if (values.is_told) return 0.0;
    for (const FittedValue& value : values.values) {
        const Effect& effect = *values.term.effect;
        const bool is_size = effect.parameters[value.parameter].linear ||
                             (effect.polar && effect.polar->size == value.parameter);
        if (!is_size || !value.ci95) continue;
        if (value.ci95->low > 0.0 || value.ci95->high < 0.0) continue;
        const double width = value.ci95->high - value.ci95->low;
        return std::min(value.ci95->high, -value.ci95->low) / std::max(width, 1e-300) + 1e-12;
    }
    return 0.0;
}

// The other log with everything that is always there.
class OtherLog {
  public:
    OtherLog(const Lens& lens, const Candidate& model, const GivenCase& other)
        : lens_(lens),
          model_(model),
          case_(other.looked_at),
          columns_(always_on(case_, model, other.given, lens.rules())) {
        const std::vector<double> own_nm = predict_nm(model.stated, case_.motion);
        open_nm_ = case_.torque_nm;
        add_scaled(-1.0, own_nm.data(), open_nm_.data(), open_nm_.size());
        if (other.given.empty()) return;
        const std::vector<double> values = lens.plain_values(std::vector<double>(lens.open_nm().size(), 0.0));
        carry(values);
    }

    /// rms that is left with these findings but one; always-on values are those of the log.
    [[nodiscard]] double left_nm(const std::vector<BesideValues>& values, std::optional<std::size_t> but) {
        const auto here_nm = torque_of_other(values, model_.stated, lens_.looked_at().motion, but);
        const std::vector<double> always = lens_.plain_values(here_nm);
        if (columns_.stated > 0) carry(always);
        std::vector<double> left = open_nm_;
        for (std::size_t i = 0; i < columns_.of_model; ++i)
            add_scaled(-always[i], columns_.torque_nm[i].data(), left.data(), left.size());
        const auto there_nm = torque_of_other(values, model_.stated, case_.motion, but);
        add_scaled(-1.0, there_nm.data(), left.data(), left.size());
        return rms_of(left, case_.use);
    }

  private:
    void carry(const std::vector<double>& values) { case_.motion.known_nm = carried_nm(columns_, values); }
    const Lens& lens_;
    const Candidate& model_;
    Case case_;
    AlwaysOn columns_;
    std::vector<double> open_nm_;
};

}  // namespace

Believed believed_of(Sums& sums, const std::vector<BesideFinding>& findings) {
    Believed believed;
    std::vector<Shape> shapes;
    for (std::size_t i = 0; i < findings.size(); ++i) {
        if (is_in_doubt(findings[i].status)) continue;
        believed.place.push_back(i);
        shapes.push_back(findings[i].shape);
    }
    believed.values = values_beside(sums, shapes);
    return believed;
}

void withdraw_what_may_be_nothing(Sums& sums, bool of_ties_too, std::vector<BesideFinding>& findings) {
    while (true) {
        const Believed believed = believed_of(sums, findings);
        std::optional<std::size_t> worst;
        double most = 0.0;
        for (std::size_t i = 0; i < believed.place.size(); ++i) {
            const bool asked = of_ties_too || findings[believed.place[i]].status == FindingStatus::confirmed;
            const double part = asked ? reach_beyond_0(believed.values[i]) : 0.0;
            if (part <= most) continue;
            most = part;
            worst = believed.place[i];
        }
        if (!worst) return;
        BesideFinding& finding = findings[*worst];
        if (finding.shape.ringing) {  // the part that passes the joint may be nothing; the ripple as a whole
                                      // is asked next
            finding.shape.ringing.reset();
            continue;
        }
        finding.status = FindingStatus::tentative;
        finding.reason = "the interval of its size holds 0";
    }
}

std::vector<OtherLeft> withdraw_on_other(Sums& sums, const Candidate& model, const GivenCase& other,
                                         std::vector<BesideFinding>& findings) {
    OtherLog log(sums.lens(), model, other);
    std::vector<OtherLeft> left(findings.size());
    const DiagnosisRules& rules = sums.lens().rules();
    while (true) {
        const Believed believed = believed_of(sums, findings);
        if (believed.place.empty()) return left;
        const double with_nm = log.left_nm(believed.values, std::nullopt);
        std::optional<std::size_t> worst;
        double most = rules.reproduction.most_left;
        for (std::size_t i = 0; i < believed.place.size(); ++i) {
            OtherLeft& here = left[believed.place[i]];
            here = {log.left_nm(believed.values, i), with_nm};
            if (with_nm / here.without_nm <= most) continue;
            most = with_nm / here.without_nm;
            worst = believed.place[i];
        }
        if (!worst) return left;
        BesideFinding& finding = findings[*worst];
        finding.status = FindingStatus::not_reproduced;
        Hearing(rules, finding.decisions).asked("reproduction.most_left", most, true);
        finding.reason = not_reproduced_words(left[*worst].without_nm, left[*worst].with_nm);
    }
}

double left_of_other(Sums& sums, const Candidate& model, const GivenCase& other,
                     const std::vector<BesideFinding>& findings) {
    return OtherLog(sums.lens(), model, other).left_nm(believed_of(sums, findings).values, std::nullopt);
}

std::string not_reproduced_words(double without_nm, double with_nm) {
    return fmt::format("it leaves {:.3g} Nm of the validation log, where {:.3g} Nm are left without it",
                       with_nm, without_nm);
}

}  // namespace ripplenotch
