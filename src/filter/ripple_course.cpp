// SPDX-License-Identifier: MIT
#include "filter/ripple_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ripplenotch {
namespace {

constexpr double worth_it = 1.05;  ///< a simpler course stays unless it leaves this much more
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
constexpr double bins_an_octave = 4.0, reach_bins = 1.5;

int speed_bin(double speed_turns_s) {
    const double octave = std::log2(std::max(std::abs(speed_turns_s), 1e-6)) + 20.0;
    return std::clamp(static_cast<int>(octave * bins_an_octave), 0, bins - 1);
}

// Everything that the courses need about one order.
class Order {
  public:
    Order(const std::vector<RippleWindow>& windows, std::size_t order) : windows_(windows), order_(order) {
        by_speed_[0].resize(bins);
        by_speed_[1].resize(bins);
        // Two of a window's neighbours, held out one by one, are as good as a few well-measured windows: no
        // weight is above ten times the median.
        std::vector<double> variances;
        for (const RippleWindow& window : windows) variances.push_back(window.variance);
        if (!variances.empty()) {
            const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
            std::nth_element(variances.begin(), middle, variances.end());
            least_variance_ = std::max(0.1 * *middle, std::numeric_limits<double>::min());
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

    /// What a course takes window i to be; without the window itself when it is held out.
    [[nodiscard]] Amplitude taken(Course course, std::size_t i, bool held_out) const {
        switch (course) {
            case Course::nothing:
                return 0.0;
            case Course::constant:
                return mean(all_, i, held_out, 0.0);
            case Course::by_direction:
                return mean(by_direction_[direction(i)], i, held_out, 0.0);
            case Course::by_speed:
                return near_speed(i, held_out);
            case Course::local:
                return near_place(i, held_out);
        }
        return 0.0;
    }

  private:
    [[nodiscard]] std::size_t direction(std::size_t i) const {
        return windows_[i].speed_turns_s < 0.0 ? 1 : 0;
    }

    [[nodiscard]] Amplitude mean(const Sum& sum, std::size_t i, bool held_out, Amplitude otherwise) const {
        Sum used = sum;
        if (held_out) used.add(value(i), -weight(i));
        return used.weight > 1e-9 * sum.weight ? used.value / used.weight : otherwise;
    }

    [[nodiscard]] Amplitude near_speed(std::size_t i, bool held_out) const {
        const int own = speed_bin(windows_[i].speed_turns_s);
        Sum used;
        for (int bin = std::max(0, own - 6); bin <= std::min(bins - 1, own + 6); ++bin) {
            const double distance = static_cast<double>(bin - own) / reach_bins;
            const double share = std::exp(-0.5 * distance * distance);
            const Sum& sum = by_speed_[direction(i)][static_cast<std::size_t>(bin)];
            used.value += share * sum.value;
            used.weight += share * sum.weight;
        }
        return mean(used, i, held_out, mean(all_, i, held_out, 0.0));
    }

    // The windows before and after in the same direction, and the window itself twice as much.
    [[nodiscard]] Amplitude near_place(std::size_t i, bool held_out) const {
        Sum used;
        if (!held_out) used.add(value(i), 2.0 * weight(i));
        const auto add = [&](std::size_t j) {
            const bool near = std::abs(windows_[j].middle - windows_[i].middle) < near_turns;
            if (near && direction(j) == direction(i)) used.add(value(j), weight(j));
        };
        if (i > 0) add(i - 1);
        if (i + 1 < windows_.size()) add(i + 1);
        return used.weight > 0.0 ? used.value / used.weight : mean(all_, i, held_out, 0.0);
    }

    static constexpr double near_turns = 20.0;
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

CourseScore choose_course(std::vector<RippleWindow>& windows, std::size_t order) {
    const Order data(windows, order);
    double power = 0.0;
    for (std::size_t i = 0; i < windows.size(); ++i) power += data.weight(i) * std::norm(data.value(i));
    std::array<double, courses.size()> left{};
    for (std::size_t c = 0; c < courses.size(); ++c) {
        double sum = 0.0;
        for (std::size_t i = 0; i < windows.size(); ++i)
            sum += data.weight(i) * std::norm(data.value(i) - data.taken(courses[c], i, true));
        left[c] = power > 0.0 ? sum / power : 1.0;
    }
    const double best = *std::min_element(left.begin(), left.end());
    const auto winner =
        std::find_if(left.begin(), left.end(), [best](double l) { return l <= worth_it * best; });
    const CourseScore score{courses[static_cast<std::size_t>(winner - left.begin())], *winner};
    std::vector<Amplitude> taken(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) taken[i] = data.taken(score.course, i, false);
    for (std::size_t i = 0; i < windows.size(); ++i) windows[i].amplitudes[order] = taken[i];
    return score;
}

}  // namespace ripplenotch
