// SPDX-License-Identifier: MIT
// Ripple fitted over the whole log in a first pass and subtracted in a second: no delay at all, but not
// causal.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "filter/method.hpp"
#include "filter/ripple/ripple_course.hpp"
#include "filter/ripple/ripple_keys.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    gear_ratio_key,
    orders_key,
    joint_key,
    Key{.name = "turns",
        .default_text = "2.5",
        .above = 2.0,
        .at_most = 1000.0,
        .help = "motor turns of the windows that the ripple is fitted in"},
    angle_key,
};

struct Plan {
    RippleOrders ripple;
    RippleWindowRule rule;
    MotorAngle::Source source = MotorAngle::Source::best;
    double sample_rate_hz = 0.0;

    [[nodiscard]] MotorPath path() const {
        return MotorPath(MotorAngle(ripple.gear_ratio, sample_rate_hz, source, 0.0));
    }
};

Plan plan(const Settings& settings, Hertz sample_rate) {
    Plan p;
    p.ripple = ripple_orders("subtract", settings);
    p.rule.turns = settings.number("turns");
    p.source = angle_source(settings);
    p.sample_rate_hz = sample_rate.value();
    return p;
}

// Subtracts what was learned; with no windows it passes the torque.
class SubtractingFilter final : public CausalFilter {
  public:
    SubtractingFilter(const Plan& plan, std::vector<RippleWindow> windows)
        : orders_(plan.ripple.orders), path_(plan.path()), windows_(std::move(windows)) {}

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            path_.next(in.velocity_deg_s[k], in.position_deg.empty() ? nullptr : &in.position_deg[k]);
            out[k] = windows_.empty() ? in.torque_nm[k] : in.torque_nm[k] - ripple();
        }
    }
    void restart() override { path_.restart(); }

  private:
    // Amplitudes change linearly along the motor's way from one window's middle to the next.
    [[nodiscard]] double ripple() {
        const double at = path_.travelled();
        while (next_ + 1 < windows_.size() && windows_[next_].middle < at) ++next_;
        const RippleWindow& after = windows_[next_];
        const RippleWindow& before = windows_[next_ > 0 ? next_ - 1 : 0];
        const double between = after.middle - before.middle;
        const double share = between > 0.0 ? std::clamp((at - before.middle) / between, 0.0, 1.0) : 1.0;
        double sum = 0.0;
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const double near = share_below_rate(orders_[i] * std::abs(path_.step_turns()));
            if (near == 0.0) continue;
            const double cycles = orders_[i] * path_.turns();
            const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
            const auto value = before.amplitudes[i] + share * (after.amplitudes[i] - before.amplitudes[i]);
            sum += near * (value.real() * portable::cos(phase) + value.imag() * portable::sin(phase));
        }
        return sum;
    }

    std::vector<double> orders_;
    MotorPath path_;
    std::vector<RippleWindow> windows_;
    std::size_t next_ = 0;
};

class SubtractLearner final : public Learner {
  public:
    explicit SubtractLearner(Plan plan)
        : plan_(std::move(plan)),
          path_(plan_.path()),
          windows_(plan_.ripple.orders, plan_.sample_rate_hz, plan_.rule) {}

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            path_.next(in.velocity_deg_s[k], in.position_deg.empty() ? nullptr : &in.position_deg[k]);
            if (!started_) origin_nm_ = in.torque_nm[k];
            started_ = true;
            // Relative to the first sample: a constant torque is fitted by exact zeros.
            windows_.add(path_, in.torque_nm[k] - origin_nm_);
            out[k] = in.torque_nm[k];
        }
    }
    void restart() override {
        windows_.split();
        path_.restart();
    }
    std::unique_ptr<CausalFilter> learned() override {
        auto windows = windows_.finish();
        notes_.clear();
        if (windows.empty()) {
            notes_.push_back(
                "the motor never turns twice in one direction within two seconds: nothing is subtracted");
        }
        for (std::size_t i = 0; i < plan_.ripple.orders.size() && !windows.empty(); ++i) {
            const CourseScore score = choose_course(windows, i);
            notes_.push_back(fmt::format("order {:g}: {}, about {:.1f} % of its power remaining ({} windows)",
                                         plan_.ripple.orders[i], course_name(score.course),
                                         100.0 * std::min(score.error, 1.0), windows.size()));
        }
        return std::make_unique<SubtractingFilter>(plan_, std::move(windows));
    }
    [[nodiscard]] std::vector<std::string> notes() const override { return notes_; }

  private:
    Plan plan_;
    MotorPath path_;
    RippleWindows windows_;
    std::vector<std::string> notes_;
    double origin_nm_ = 0.0;
    bool started_ = false;
};

std::unique_ptr<Learner> learner(const Settings& settings, Hertz sample_rate) {
    return std::make_unique<SubtractLearner>(plan(settings, sample_rate));
}

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    return std::make_unique<SubtractingFilter>(plan(settings, sample_rate), std::vector<RippleWindow>{});
}

FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable*, DegPerSec) {
    (void)plan(settings, sample_rate);
    return {{}, "subtracts; passes all else", true};
}

}  // namespace

const Method filter_methods::subtract = {
    .name = "subtract",
    .summary = "ripple fitted in the motor angle over the whole log, then subtracted: two passes, no delay",
    .source = "least squares in the motor angle; held-out scores as Stone 1974",
    .keys = keys,
    .start = start,
    .frozen = frozen,
    .learner = learner,
};

}  // namespace ripplenotch
