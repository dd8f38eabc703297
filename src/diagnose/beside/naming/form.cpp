// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/form.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/beside/naming/evidence.hpp"
#include "diagnose/beside/naming/exchanges.hpp"
#include "diagnose/beside/weighing/sameness.hpp"

namespace ripplenotch {

bool stands_beside(const Sums& sums, const Names& rivals, std::size_t own, double price) {
    Names both = rivals;
    both.push_back(own);
    return is_worth(gain_between(sums, rivals, both), price, sums.lens().rules().beside);
}

bool drives(const Sums& sums, const Names& names, std::size_t place) {
    const Kind kind = kind_of(*sums.shapes()[names[place]].term.effect);
    return (kind == Kind::friction || kind == Kind::speed) &&
           sums.sizes(names)[columns_at(sums, names, place).first] <= 0.0;
}

double swing_nm(const Sums& sums, const Names& names, std::size_t place) {
    const OwnColumns own = columns_at(sums, names, place);
    const Eigen::VectorXd all = sums.sizes(names);
    const auto columns = sums.lens().torque_nm(sums.shapes()[names[place]]);
    const auto& use = sums.lens().looked_at().use;
    double sum = 0.0, square = 0.0, count = 0.0;
    for (std::size_t k = 0; k < use.size(); ++k) {
        if (use[k] == 0) continue;
        double torque = 0.0;
        for (std::size_t c = 0; c < columns.size(); ++c)
            torque += all[own.first + static_cast<Eigen::Index>(c)] * columns[c][k];
        sum += torque;
        square += torque * torque;
        count += 1.0;
    }
    return std::sqrt(std::max(square / count - sum / count * (sum / count), 0.0));
}

double mended_part(const Sums& sums, const Names& names, std::size_t place, std::size_t effects) {
    double part = 0.0;
    if (kind_of(*sums.shapes()[names[place]].term.effect) != Kind::speed) return part;
    for (std::size_t other = 0; other < sums.listed(); ++other) {
        if (is_among(sums, names, sums.shapes()[other]) || !sums.is_told(other)) continue;
        Names both = names;
        both.push_back(other);
        if (!drives(sums, both, names.size()) ||
            !stands_beside(sums, names, other, price_of(sums, other, effects)))
            continue;
        part = std::max(part, swing_nm(sums, both, names.size()) / swing_nm(sums, both, place));
    }
    return part;
}

}  // namespace ripplenotch
