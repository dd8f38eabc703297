// SPDX-License-Identifier: MIT
#include "filter/ripple/ripple_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// A simpler course stays unless another leaves this much less: one per cent of the ripple's power, 20 dB
// below it, or a twentieth.
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

// Speeds in quarter octaves, two directions; what a window takes from another falls with their distance.
constexpr int bins = 160;
constexpr int most_bins_apart = 6;                        // by hand
constexpr double bins_an_octave = 4.0, reach_bins = 1.5;  // by hand

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

    /// What a course takes window i to be; without the window itself, and what shares samples with it, when
    /// it is held out.
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

// What a held-out window shows is the ripple and what else there is at that frequency. A course that knew the
// ripple exactly would leave that background; how much it leaves beyond it is its own error. A window's own
// amplitude errs by the background.
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
