// SPDX-License-Identifier: MIT
#include "core/text/fixed_texts.hpp"

#include <algorithm>

#include "core/text/print_fixed.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void FixedTexts::prepare(std::span<const double> values, double divisor, int decimals) {
    values_ = values;
    divisor_ = divisor;
    decimals_ = decimals;
    if (!wide_vectors() || decimals < 0 || decimals > most_decimals_side_by_side) {
        std::fill_n(lengths_.begin(), values.size(), 0);
        return;
    }
    std::array<double, most> quotients;
    if (divisor != 1.0) {
        std::transform(values.begin(), values.end(), quotients.begin(),
                       [divisor](double value) { return value / divisor; });
        values = {quotients.data(), values.size()};
    }
    print_fixed(values, decimals, mark_, slots_.data(), lengths_.data());
}

char* FixedTexts::put_alone(char* into, std::size_t i) const {
    char* const end = put_fixed(into, values_[i] / divisor_, decimals_);
    if (mark_ != '.') std::replace(into, end, '.', mark_);
    return end;
}

}  // namespace ripplenotch
