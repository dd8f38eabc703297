// SPDX-License-Identifier: MIT
#include "diagnose/beside/evidence.hpp"

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

double price_of(const Sums& sums, std::size_t shape, std::size_t effects) {
    const Shape& priced = sums.shapes()[shape];
    double places = 0.0;
    for (std::size_t i = 0; i < sums.listed(); ++i) {
        if (sums.shapes()[i].term.effect == priced.term.effect) places += 1.0;
    }
    const auto values = static_cast<double>(columns_of(priced) + scales_of(*priced.term.effect).size());
    const double samples = static_cast<double>(sums.lens().ground().rows());
    return values * portable::log(samples) + 2.0 * portable::log(places) +
           2.0 * portable::log(static_cast<double>(effects) / sums.lens().rules().screening.false_alarm);
}

}  // namespace ripplenotch
