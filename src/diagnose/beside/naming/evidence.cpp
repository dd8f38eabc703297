// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/evidence.hpp"

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

double price_of_values(const Sums& sums, std::size_t values, std::size_t places, std::size_t effects) {
    const auto samples = static_cast<double>(sums.lens().ground().rows());
    return static_cast<double>(values) * portable::log(samples) +
           2.0 * portable::log(static_cast<double>(places)) +
           2.0 * portable::log(static_cast<double>(effects) / sums.lens().rules().screening.false_alarm);
}

}  // namespace

double price_of(const Sums& sums, std::size_t shape, std::size_t effects) {
    const Shape& priced = sums.shapes()[shape];
    std::size_t places = 0;
    for (std::size_t i = 0; i < sums.listed(); ++i) {
        const Shape& other = sums.shapes()[i];
        if (other.term.effect == priced.term.effect &&
            other.ringing.has_value() == priced.ringing.has_value())
            ++places;
    }
    // Out of fold a column that explains nothing costs itself. What rings is priced by the places tried.
    const std::size_t values = columns_of({priced.term}) + scales_of(*priced.term.effect).size();
    return price_of_values(sums, values, places, effects);
}

double price_of_ringing(const Sums& sums, std::size_t shape, std::size_t effects) {
    const Shape& priced = sums.shapes()[shape];
    std::size_t places = 0;
    for (std::size_t i = 0; i < sums.listed(); ++i)
        places += sums.shapes()[i].ringing && same_name(sums.shapes()[i], priced) ? 1 : 0;
    return price_of_values(sums, 2, places, effects);
}

OutsideGain gain_between(const Sums& sums, const Names& without, const Names& with) {
    return outside_gain(sums.residual_outside(without), sums.residual_outside(with),
                        sums.lens().ground().blocks(), sums.lens().sigma());
}

}  // namespace ripplenotch
