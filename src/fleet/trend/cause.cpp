// SPDX-License-Identifier: MIT
#include "fleet/trend/cause.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double took_part = 16.0;  // t squared of a descriptor that changed for certain

/// A cause and the series that it would change: a column for each free number.
struct Hypothesis {
    std::string name;
    std::vector<VectorXd> columns;
};

bool is_phase(const Series& series) { return series.name.ends_with("_phase_deg"); }
bool is_ripple(const Series& series) {
    return series.name.starts_with("ripple_") && series.name.ends_with("_amplitude_nm");
}
// "2" of "ripple_2_amplitude_nm"
std::string order_of(const Series& series) { return series.name.substr(7, series.name.find('_', 7) - 7); }

class Namer {
  public:
    Namer(const JointHistory& history, const std::vector<ChangedSeries>& changed)
        : history_(history), changed_(changed) {
        single("coulomb_friction_nm", "Coulomb friction");
        single("viscous_friction_nm_per_deg_s", "viscous friction");
        single("load_friction_nm_per_nm", "load friction");
        single("lost_motion_deg", "lost motion");
        single("sensor_zero_nm", "zero of the torque sensor");
        single("noise_floor_nm", "noise of the torque sensor");
        single("inertia_kgm2", "inertia of the load");
        single("gravity_nm", "weight of the load");
        several("friction", {"coulomb_friction_nm", "viscous_friction_nm_per_deg_s"});
        several("load", {"inertia_kgm2", "gravity_nm"});
        ripple();
        gain();
        phases();
        ratio();
    }
    [[nodiscard]] const std::vector<Hypothesis>& list() const { return list_; }

  private:
    [[nodiscard]] const Series& series(std::size_t i) const { return history_.series[changed_[i].series]; }
    [[nodiscard]] VectorXd unit(std::size_t i) const {
        return VectorXd::Unit(static_cast<Index>(changed_.size()), static_cast<Index>(i));
    }
    template <class Holds>
    std::vector<VectorXd> units_where(Holds holds) const {
        std::vector<VectorXd> found;
        for (std::size_t i = 0; i < changed_.size(); ++i)
            if (holds(series(i))) found.push_back(unit(i));
        return found;
    }
    void single(const std::string& name, const std::string& cause) {
        auto columns = units_where([&](const Series& one) { return one.name == name; });
        if (!columns.empty()) list_.push_back({cause, std::move(columns)});
    }
    void several(const std::string& cause, const std::vector<std::string>& names) {
        auto columns = units_where([&](const Series& one) {
            return std::find(names.begin(), names.end(), one.name) != names.end();
        });
        if (columns.size() > 1) list_.push_back({cause, std::move(columns)});
    }
    void ripple() {
        for (std::size_t i = 0; i < changed_.size(); ++i)
            if (is_ripple(series(i))) list_.push_back({"ripple of order " + order_of(series(i)), {unit(i)}});
    }
    // Another gain moves all torques by the same part of each.
    void gain() {
        VectorXd column = VectorXd::Zero(static_cast<Index>(changed_.size()));
        int torques = 0;
        for (std::size_t i = 0; i < changed_.size(); ++i) {
            if (!series(i).torque || series(i).name == "sensor_zero_nm") continue;
            column[static_cast<Index>(i)] = changed_[i].baseline;
            ++torques;
        }
        if (torques > 1) list_.push_back({"gain of the torque sensor", {column}});
    }
    void phases() {
        auto columns = units_where(is_phase);
        if (!columns.empty())
            list_.push_back({"phase of the ripple (encoder or gear set anew)", std::move(columns)});
    }
    // A ripple that is measured at the order of another gear is none of either.
    void ratio() {
        auto columns = units_where(
            [](const Series& one) { return one.name == "gear_ratio" || is_phase(one) || is_ripple(one); });
        const auto own = units_where([](const Series& one) { return one.name == "gear_ratio"; });
        const bool itself = std::any_of(changed_.begin(), changed_.end(), [&](const ChangedSeries& one) {
            return history_.series[one.series].name == "gear_ratio" && one.extra.t_squared >= took_part;
        });
        if (own.empty() || !itself) return;
        list_.push_back({"gear ratio (another gear)", own});
        if (columns.size() > 1) list_.push_back({"gear ratio (another gear)", std::move(columns)});
    }

    const JointHistory& history_;
    const std::vector<ChangedSeries>& changed_;
    std::vector<Hypothesis> list_;
};

// Correlation of the residuals of the series at the rows that all of them have, without the change.
MatrixXd correlation_of(const JointHistory& history, const std::vector<Regression>& known,
                        const FoundChange& change, const std::vector<ChangedSeries>& changed) {
    const auto d = static_cast<Index>(changed.size()), n = static_cast<Index>(history.lines.size());
    MatrixXd residual = MatrixXd::Zero(n, d);
    for (Index i = 0; i < d; ++i) {
        const ChangedSeries& one = changed[static_cast<std::size_t>(i)];
        const auto& rows = history.series[one.series].rows;
        const auto column = known[one.series].beside(change_column(history, change, rows));
        const auto& before = known[one.series].residual();
        for (std::size_t k = 0; k < rows.size(); ++k)
            residual(static_cast<Index>(rows[k]), i) = before[k] - one.extra.size * column[k];
        const double size = residual.col(i).norm();
        if (size > 0.0) residual.col(i) /= size;
    }
    MatrixXd correlation = residual.transpose() * residual;
    // Estimates from few logs are drawn towards zero correlation.
    const double kept = static_cast<double>(n) / static_cast<double>(n + 2 * d);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) correlation(i, j) = i == j ? 1.0 : kept * correlation(i, j);
    return correlation;
}

// The error of a size by its own scatter and by that of the joint's kin, as the test has it.
void lean_on(const Scatter& kin, double unit_squared, double freedom, const std::vector<double>& column,
             Extra& extra) {
    double squares = 0.0;
    for (const double value : column) squares += value * value;
    const double own = extra.error * extra.error * squares;
    const double both = (freedom * own + kin.freedom * kin.variance * unit_squared) / (freedom + kin.freedom);
    extra.error *= std::sqrt(both / own);
    extra.t_squared *= own / both;
}

}  // namespace

std::vector<ChangedSeries> changed_series(const JointHistory& history, const std::vector<Regression>& known,
                                          const ScatterOfSeries& scatter, const FoundChange& change) {
    std::vector<ChangedSeries> changed;
    for (std::size_t s = 0; s < known.size(); ++s) {
        const Series& series = history.series[s];
        const auto column = change_column(history, change, series.rows);
        auto extra = known[s].extra(column);
        if (!extra || !(extra->error > 0.0)) continue;
        if (const auto kin = scatter.find(series.name); kin != scatter.end()) {
            const double unit = unit_of(series, known[s]);
            lean_on(kin->second, unit * unit, known[s].freedom() - 1.0, known[s].beside(column), *extra);
        }
        changed.push_back({s, *extra, known[s].first_value()});
    }
    return changed;
}

std::string cause_of(const JointHistory& history, const std::vector<Regression>& known,
                     const FoundChange& change, const std::vector<ChangedSeries>& changed) {
    const auto d = static_cast<Index>(changed.size());
    VectorXd sizes(d), errors(d);
    for (Index i = 0; i < d; ++i) {
        sizes[i] = changed[static_cast<std::size_t>(i)].extra.size;
        errors[i] = changed[static_cast<std::size_t>(i)].extra.error;
    }
    const MatrixXd correlation = correlation_of(history, known, change, changed);
    const MatrixXd root = DefiniteFactors(correlation).lower();
    const auto whitened = [&](const VectorXd& v) -> VectorXd {
        return root.triangularView<Eigen::Lower>().solve(v.cwiseQuotient(errors));
    };
    const VectorXd seen = whitened(sizes);
    const double price = portable::log(static_cast<double>(history.lines.size()));
    const Namer namer(history, changed);
    const Hypothesis* best = nullptr;
    double least = 0.0;
    VectorXd left_by_best;
    for (const Hypothesis& one : namer.list()) {
        MatrixXd columns(d, static_cast<Index>(one.columns.size()));
        for (std::size_t c = 0; c < one.columns.size(); ++c)
            columns.col(static_cast<Index>(c)) = whitened(one.columns[c]);
        const VectorXd values = RankedFactors(columns).solve(seen);
        const double left = (seen - columns * values).squaredNorm();
        const double score = left + price * static_cast<double>(one.columns.size());
        if (best != nullptr && score >= least) continue;
        best = &one;
        least = score;
        left_by_best = root.triangularView<Eigen::Lower>() * (seen - columns * values);
    }
    // No other descriptor has a significant change that this cause does not explain.
    if (best != nullptr && left_by_best.cwiseAbs2().maxCoeff() < took_part) return best->name;
    return "several at once: " + joined(changed, ", ", [&](const ChangedSeries& one) {
               return one.extra.t_squared >= took_part ? history.series[one.series].name : std::string();
           });
}

}  // namespace ripplenotch
