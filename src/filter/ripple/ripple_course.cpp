// SPDX-License-Identifier: MIT
#include "filter/ripple/ripple_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr Eigen::Index trend_terms = 4;
constexpr double reversal_turns = 0.25;    // chosen, not derived: turns of the motor
constexpr double samples_a_period = 3.0;   // as in ripple_meter.cpp
constexpr double beyond_a_gap = 1e9;       // chosen, not derived: farther than any window
constexpr double trend_terms_reach = 1.5;  ///< cycles a window that a cubic may follow

}  // namespace

void MotorPath::next(double velocity_deg_s, const double* position_deg) noexcept {
    angle_.next(velocity_deg_s, position_deg);
    travelled_ += std::abs(angle_.step_turns());
}

void MotorPath::restart() noexcept {
    angle_.restart();
    travelled_ += beyond_a_gap;
}

RippleWindows::RippleWindows(std::vector<double> orders, double sample_rate_hz, RippleWindowRule rule)
    : orders_(std::move(orders)), rate_hz_(sample_rate_hz), rule_(rule) {}

void RippleWindows::begin(const MotorPath& path) {
    turns_.clear();
    torque_nm_.clear();
    first_turns_ = path.turns();
    first_travelled_ = path.travelled();
    furthest_ = 0.0;
}

void RippleWindows::add(const MotorPath& path, double torque_nm) {
    if (turns_.empty()) begin(path);
    double turned = path.turns() - first_turns_;
    const bool turned_back =
        std::abs(furthest_) - std::abs(turned) > reversal_turns || turned * furthest_ < 0.0;
    const bool too_long = static_cast<double>(turns_.size()) >= rule_.longest_s * rate_hz_;
    if (turned_back || too_long) {
        close();
        begin(path);
    } else if (std::abs(furthest_) >= rule_.turns) {
        close();
        keep_second_half();
    }
    turned = path.turns() - first_turns_;
    turns_.push_back(turned);
    torque_nm_.push_back(torque_nm);
    if (std::abs(turned) > std::abs(furthest_)) furthest_ = turned;
}

void RippleWindows::keep_second_half() {
    const auto half = std::find_if(turns_.begin(), turns_.end(), [this](double turned) {
        return std::abs(turned) >= 0.5 * std::abs(furthest_);
    });
    const auto cut = half - turns_.begin();
    const double moved = *half;
    turns_.erase(turns_.begin(), half);
    torque_nm_.erase(torque_nm_.begin(), torque_nm_.begin() + cut);
    for (double& turned : turns_) turned -= moved;
    first_turns_ += moved;
    first_travelled_ += std::abs(moved);
    furthest_ -= moved;
}

void RippleWindows::split() {
    close();
    turns_.clear();
}

std::vector<RippleWindow> RippleWindows::finish() {
    split();
    return std::move(windows_);
}

// Mean square of cosine and sine amplitude, as the fit of an order would find it, at half an order to both
// sides; 0 where every such place belongs to another order or to the trend.
double RippleWindows::background(std::size_t order, std::span<const double> residual,
                                 std::span<const double> weight) const {
    double sum = 0.0, places = 0.0;
    for (const double aside : {-0.5, 0.5}) {
        const double place = orders_[order] + aside;
        const bool taken = std::any_of(orders_.begin(), orders_.end(),
                                       [place](double other) { return std::abs(other - place) < 0.35; });
        if (taken || place * rule_.turns < trend_terms_reach) continue;
        std::complex<double> found = 0.0;
        double weights = 0.0;
        for (std::size_t k = 0; k < residual.size(); ++k) {
            const double cycles = place * turns_[k];
            found += weight[k] * residual[k] *
                     portable::polar(1.0, 2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
            weights += weight[k];
        }
        sum += std::norm(2.0 * found / weights);
        places += 1.0;
    }
    return places > 0.0 ? sum / places : 0.0;
}

// Weighted least squares of a cubic in time and every order in the motor angle. The angle is taken as it
// stands, so that phases of all windows are of one angle.
void RippleWindows::close() {
    const auto rows = static_cast<Eigen::Index>(turns_.size());
    const auto columns = trend_terms + static_cast<Eigen::Index>(2 * orders_.size());
    const double highest = *std::max_element(orders_.begin(), orders_.end());
    const bool sampled = static_cast<double>(rows) > samples_a_period * highest * std::abs(furthest_);
    if (std::abs(furthest_) < rule_.fewest_turns || rows < 2 * columns || !sampled) return;
    Eigen::MatrixXd basis(rows, columns);
    Eigen::VectorXd weight(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const auto row = static_cast<std::size_t>(k);
        const double place = (static_cast<double>(k) + 0.5) / static_cast<double>(rows);
        weight(k) = portable::sin(std::numbers::pi * place);
        double power = 1.0;
        for (Eigen::Index i = 0; i < trend_terms; ++i, power *= 2.0 * place - 1.0) basis(k, i) = power;
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const double cycles = orders_[i] * (first_turns_ + turns_[row]);
            const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
            const std::complex<double> phasor = portable::phasor(phase);
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i)) = phasor.real();
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i + 1)) = phasor.imag();
        }
    }
    const Eigen::Map<const Eigen::VectorXd> torque(torque_nm_.data(), rows);
    const Eigen::MatrixXd normal = basis.transpose() * weight.asDiagonal() * basis;
    const Eigen::VectorXd right = basis.transpose() * weight.asDiagonal() * torque;
    const Eigen::VectorXd fit = SymmetricFactors(normal).solve(right);
    if (!fit.allFinite()) return;
    const Eigen::VectorXd residual = torque - basis * fit;
    const double variance = residual.squaredNorm() / static_cast<double>(rows - columns);
    RippleWindow window;
    window.middle = first_travelled_ + 0.5 * std::abs(furthest_);
    window.length = std::abs(furthest_);
    window.speed_turns_s = furthest_ * rate_hz_ / static_cast<double>(rows);
    window.variance = 2.0 * variance * weight.squaredNorm() / portable::pow(weight.sum(), 2);
    window.middle_turns =
        first_turns_ + weight.dot(Eigen::Map<const Eigen::VectorXd>(turns_.data(), rows)) / weight.sum();
    window.torque_nm = weight.dot(torque) / weight.sum();
    const auto count = static_cast<std::size_t>(rows);
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        const auto at = trend_terms + static_cast<Eigen::Index>(2 * i);
        window.amplitudes.emplace_back(fit(at), fit(at + 1));
        window.background.push_back(background(i, {residual.data(), count}, {weight.data(), count}));
    }
    windows_.push_back(std::move(window));
}

namespace {

// A simpler course is kept unless the residual of another is smaller by this: one per cent of the ripple's
// power, 20 dB below it, or a twentieth.
constexpr double worth_it = 1.05, not_worth_it = 0.01;
constexpr std::array courses = {Course::nothing, Course::constant, Course::by_direction, Course::by_speed,
                                Course::local};

using Amplitude = std::complex<double>;

struct Sum {
    Amplitude value = 0.0;
    double weight = 0.0;
    void add(Amplitude amplitude, double w) {
        value += w * amplitude;
        weight += w;
    }
};

// Speeds in quarter octaves, two directions; the weight of one window for another falls with their distance.
constexpr int bins = 160;
constexpr int most_bins_apart = 6;                        // chosen, not derived
constexpr double bins_an_octave = 4.0, reach_bins = 1.5;  // chosen, not derived

int speed_bin(double speed_turns_s) {
    const double octave = portable::log2(std::max(std::abs(speed_turns_s), 1e-6)) + 20.0;
    return std::clamp(static_cast<int>(octave * bins_an_octave), 0, bins - 1);
}

// Everything that the courses need about one order.
class OrderCourse {
  public:
    OrderCourse(const std::vector<RippleWindow>& windows, std::size_t order)
        : windows_(windows), order_(order) {
        by_speed_[0].resize(bins);
        by_speed_[1].resize(bins);
        // Two of a window's neighbours, held out one by one, are as good as a few well-measured windows: no
        // weight is above ten times the median.
        std::vector<double> variances;
        for (const RippleWindow& window : windows) variances.push_back(window.variance);
        if (!variances.empty()) {
            least_variance_ = std::max(0.1 * median_in(variances), std::numeric_limits<double>::min());
        }
        for (std::size_t i = 0; i < windows.size(); ++i) {
            all_.add(value(i), weight(i));
            by_direction_[direction(i)].add(value(i), weight(i));
            by_speed_[direction(i)][static_cast<std::size_t>(speed_bin(windows[i].speed_turns_s))].add(
                value(i), weight(i));
        }
    }

    [[nodiscard]] double weight(std::size_t i) const {
        return 1.0 / std::max(windows_[i].variance, least_variance_);
    }
    [[nodiscard]] Amplitude value(std::size_t i) const { return windows_[i].amplitudes[order_]; }

    /// The estimate of a course for window i; without the window itself, and those that share samples with
    /// it, when it is held out.
    [[nodiscard]] Amplitude taken(Course course, std::size_t i, bool held_out) const {
        switch (course) {
            case Course::nothing:
                return 0.0;
            case Course::constant:
                return over_all(i, held_out);
            case Course::by_direction:
                return over_direction(i, held_out);
            case Course::by_speed:
                return near_speed(i, held_out);
            case Course::local:
                return value(i);
        }
        return 0.0;
    }

  private:
    [[nodiscard]] std::size_t direction(std::size_t i) const {
        return windows_[i].speed_turns_s < 0.0 ? 1 : 0;
    }

    // Windows that share samples are held out together.
    template <class Use>
    void each_held_out(std::size_t i, Use use) const {
        const auto shares = [&](std::size_t j) {
            const double apart = std::abs(windows_[j].middle - windows_[i].middle);
            return apart < 0.49 * (windows_[j].length + windows_[i].length);
        };
        use(i);
        for (std::size_t j = i; j > 0 && shares(j - 1); --j) use(j - 1);
        for (std::size_t j = i + 1; j < windows_.size() && shares(j); ++j) use(j);
    }

    [[nodiscard]] static Amplitude mean(const Sum& used, const Sum& before, Amplitude otherwise) {
        return used.weight > 1e-9 * before.weight ? used.value / used.weight : otherwise;
    }

    [[nodiscard]] Amplitude over_all(std::size_t i, bool held_out) const {
        Sum used = all_;
        if (held_out) each_held_out(i, [&](std::size_t j) { used.add(value(j), -weight(j)); });
        return mean(used, all_, 0.0);
    }

    [[nodiscard]] Amplitude over_direction(std::size_t i, bool held_out) const {
        const Sum& whole = by_direction_[direction(i)];
        Sum used = whole;
        if (held_out) {
            each_held_out(i, [&](std::size_t j) {
                if (direction(j) == direction(i)) used.add(value(j), -weight(j));
            });
        }
        return mean(used, whole, 0.0);
    }

    [[nodiscard]] static double nearness(int bin, int other) {
        const double distance = static_cast<double>(bin - other) / reach_bins;
        return std::abs(bin - other) <= most_bins_apart ? portable::exp(-0.5 * distance * distance) : 0.0;
    }

    [[nodiscard]] Amplitude near_speed(std::size_t i, bool held_out) const {
        const int own = speed_bin(windows_[i].speed_turns_s);
        Sum used;
        for (int bin = std::max(0, own - most_bins_apart); bin <= std::min(bins - 1, own + most_bins_apart);
             ++bin) {
            const Sum& sum = by_speed_[direction(i)][static_cast<std::size_t>(bin)];
            used.value += nearness(bin, own) * sum.value;
            used.weight += nearness(bin, own) * sum.weight;
        }
        const Sum whole = used;
        if (held_out) {
            each_held_out(i, [&](std::size_t j) {
                if (direction(j) == direction(i))
                    used.add(value(j), -nearness(speed_bin(windows_[j].speed_turns_s), own) * weight(j));
            });
        }
        return mean(used, whole, over_all(i, held_out));
    }

    const std::vector<RippleWindow>& windows_;
    std::size_t order_;
    double least_variance_ = std::numeric_limits<double>::min();
    Sum all_;
    std::array<Sum, 2> by_direction_;
    std::array<std::vector<Sum>, 2> by_speed_;
};

}  // namespace

std::string_view course_name(Course course) {
    switch (course) {
        case Course::nothing:
            return "not subtracted";
        case Course::constant:
            return "one amplitude and phase";
        case Course::by_direction:
            return "by direction";
        case Course::by_speed:
            return "by speed and direction";
        case Course::local:
            return "changing along the log";
    }
    return "";
}

// A held-out window shows the ripple and any other torque at that frequency. The residual of a course that
// knew the ripple exactly would be that background; the excess over it is the course's own error. A window's
// own amplitude errs by the background.
CourseScore choose_course(std::vector<RippleWindow>& windows, std::size_t order) {
    const OrderCourse data(windows, order);
    double power = 0.0, background = 0.0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
        power += data.weight(i) * std::norm(data.value(i));
        background += data.weight(i) * std::max(windows[i].background[order], windows[i].variance);
    }
    if (!(power > 0.0)) power = 1.0;
    background = std::min(background / power, 1.0);
    std::array<double, courses.size()> error{};
    for (std::size_t c = 0; c < courses.size(); ++c) {
        double sum = 0.0;
        for (std::size_t i = 0; i < windows.size(); ++i)
            sum += data.weight(i) * std::norm(data.value(i) - data.taken(courses[c], i, true));
        error[c] = courses[c] == Course::local ? background : std::max(sum / power - background, 0.0);
    }
    const double best = *std::min_element(error.begin(), error.end());
    const auto winner = std::find_if(error.begin(), error.end(), [best](double e) {
        return e <= std::max(worth_it * best, best + not_worth_it);
    });
    const CourseScore score{courses[static_cast<std::size_t>(winner - error.begin())], *winner};
    std::vector<Amplitude> taken(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) taken[i] = data.taken(score.course, i, false);
    for (std::size_t i = 0; i < windows.size(); ++i) windows[i].amplitudes[order] = taken[i];
    return score;
}

}  // namespace ripplenotch
