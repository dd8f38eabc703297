// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/contender.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t longest_run = 10'000'000;  // samples; 80 MB of output
constexpr std::size_t block_samples = 16384;     // chosen, not derived

// One filter and one signal, extended by further samples on request.
class Run {
  public:
    Run(const Contender& contender, Hertz sample_rate, DegPerSec speed)
        : filter_(contender.start_on_bench(sample_rate)),
          method_(contender.text),
          rate_hz_(sample_rate.value()),
          speed_deg_s_(speed.value()) {}

    /// Feeds samples until `count` have been; sample k is signal(k).
    template <class Signal>
    void extend(std::size_t count, const Signal& signal) {
        if (count > longest_run) {
            raise<UsageError>(
                "{}: the output has not come to rest after {:.3g} samples; it cannot be measured", method_,
                static_cast<double>(out_.size()));
        }
        const std::vector<double> velocity(block_samples, speed_deg_s_);
        std::vector<double> torque(block_samples), position(block_samples);
        while (out_.size() < count) {
            const std::size_t first = out_.size(), added = std::min(block_samples, count - first);
            for (std::size_t i = 0; i < added; ++i) {
                torque[i] = signal(first + i);
                position[i] = speed_deg_s_ * static_cast<double>(first + i) / rate_hz_;
            }
            out_.resize(first + added);
            const auto part = [added](const std::vector<double>& all) { return std::span(all).first(added); };
            filter_->process({part(velocity), part(torque), part(position)}, std::span(out_).subspan(first));
        }
    }
    [[nodiscard]] const std::vector<double>& out() const { return out_; }

  private:
    std::unique_ptr<CausalFilter> filter_;
    const std::string& method_;
    double rate_hz_, speed_deg_s_;
    std::vector<double> out_;
};

// Half a second at first, then twice as long each time, until the second half of the run is settled.
std::size_t first_length(Hertz sample_rate) {
    return std::max<std::size_t>(64, static_cast<std::size_t>(std::min(0.5 * sample_rate.value(), 1e6)));
}

std::size_t run_in(Hertz sample_rate) {
    return static_cast<std::size_t>(std::llround(run_in_seconds * sample_rate.value()));
}

constexpr double rounding_share = 1e-8;  // of what a signal has risen to: less is no overshoot

// Amplitude of the sine of `omega` radians per sample in y[from, end), fitted together with a constant.
double sine_amplitude(std::span<const double> y, std::size_t from, double omega) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t k = from; k < y.size(); ++k) {
        const std::complex<double> on_circle = portable::phasor(omega * static_cast<double>(k));
        const Eigen::Vector3d row(on_circle.real(), on_circle.imag(), 1.0);
        normal += row * row.transpose();
        right += row * y[k];
    }
    const Eigen::VectorXd fit = SymmetricFactors(normal).solve(Eigen::VectorXd(right));
    return portable::hypot(fit[0], fit[1]);
}

}  // namespace

StepMeasurement Bench::step(NewtonMeters height) const {
    const double h = height.value();
    if (!std::isfinite(h) || h == 0.0) raise<UsageError>("a step of {} Nm is no step", h);
    Run run(contender_, sample_rate_, speed_);
    const std::size_t before = run_in(sample_rate_);
    const auto signal = [h, before](std::size_t k) { return k <= before ? 0.0 : h; };
    const double rest = 0.01 * settle_bands_percent.front() / 100.0;
    std::size_t count = first_length(sample_rate_) + 2 * before;
    while (true) {
        run.extend(count, signal);
        const auto half = run.out().begin() + static_cast<std::ptrdiff_t>(count / 2);
        if (std::all_of(half, run.out().end(), [&](double y) { return std::abs(y / h - 1.0) <= rest; }))
            break;
        count *= 2;
    }
    StepMeasurement figures;
    std::array<std::size_t, 4> settled{};
    double over = 0.0, under = 0.0;
    for (std::size_t k = before + 1; k < count; ++k) {
        const double y = run.out()[k] / h;
        over = std::max(over, y - 1.0);
        under = std::max(under, -y);
        for (std::size_t b = 0; b < settled.size(); ++b) {
            if (!(std::abs(y - 1.0) <= settle_bands_percent[b] / 100.0)) settled[b] = k - before;
        }
    }
    for (std::size_t b = 0; b < settled.size(); ++b) {
        figures.settle[b] = Seconds(static_cast<double>(settled[b]) / sample_rate_.value());
    }
    figures.overshoot_percent = over > rounding_share ? 100.0 * over : 0.0;
    figures.undershoot_percent = under > rounding_share ? 100.0 * under : 0.0;
    return figures;
}

RampMeasurement Bench::ramp(double slope_nm_s) const {
    if (!std::isfinite(slope_nm_s) || slope_nm_s == 0.0)
        raise<UsageError>("a ramp of {} Nm/s is no ramp", slope_nm_s);
    const double rise = slope_nm_s / sample_rate_.value();  // per sample
    const std::size_t before = run_in(sample_rate_);
    const auto signal = [rise, before](std::size_t k) {
        return k <= before ? 0.0 : rise * static_cast<double>(k - before);
    };
    Run run(contender_, sample_rate_, speed_);
    constexpr double rest_s = 1e-8;  // chosen, not derived
    std::size_t count = first_length(sample_rate_) + 2 * before;
    while (true) {
        run.extend(count, signal);
        const auto lag_s = [&](std::size_t k) { return (signal(k) - run.out()[k]) / slope_nm_s; };
        const double last = lag_s(count - 1);
        bool at_rest = true;
        for (std::size_t k = count / 2; k < count && at_rest; ++k)
            at_rest = std::abs(lag_s(k) - last) <= rest_s;
        if (at_rest) {
            double beyond_s = 0.0;
            for (std::size_t k = before + 1; k < count; ++k)
                beyond_s = std::max({beyond_s, -lag_s(k), -run.out()[k] / slope_nm_s});
            const double risen_s = static_cast<double>(count - before) / sample_rate_.value();
            return {Seconds(last),
                    beyond_s > rounding_share * risen_s ? beyond_s * std::abs(slope_nm_s) : 0.0};
        }
        count *= 2;
    }
}

std::optional<double> Bench::attenuation_db(Hertz at) const {
    if (!(at.value() > 0.0) || !(at < 0.5 * sample_rate_)) return std::nullopt;
    const double omega = 2.0 * std::numbers::pi * (at / sample_rate_);
    const auto signal = [omega](std::size_t k) { return portable::sin(omega * static_cast<double>(k)); };
    Run run(contender_, sample_rate_, speed_);
    // Three quarters of a run to settle, one to measure; it must hold a few periods to separate the sine from
    // a constant.
    const auto periods = static_cast<std::size_t>(std::min(16.0 * (sample_rate_ / at), 1e7));
    std::size_t count = std::max(first_length(sample_rate_), periods);
    double before = std::numeric_limits<double>::infinity();
    const double least = portable::pow(10.0, -most_attenuation_db / 20.0);
    while (true) {
        run.extend(count, signal);
        const double now = sine_amplitude(run.out(), count - count / 4, omega);
        if (now < least) return most_attenuation_db;
        if (std::abs(now - before) <= 1e-6 * now + 0.1 * least) return -20.0 * portable::log10(now);
        before = now;
        count *= 2;
    }
}

}  // namespace ripplenotch
