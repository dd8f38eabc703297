// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/offset.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

std::optional<OffsetBeside> offset_beside(const Lens& lens, const Candidate& model,
                                          std::span<const Effect* const> examined,
                                          std::vector<Shape> believed) {
    const Effect* const offset = &find_effect("offset");
    if (std::find(examined.begin(), examined.end(), offset) == examined.end()) return std::nullopt;
    const Lens open(Lens::OffsetIsOpen{}, lens, model, {&offset, 1});
    Sums sums(open);
    if (sums.listed() != 1) return std::nullopt;
    const double part = open.weighed(sums.shapes()[0]).part;
    if (part < lens.rules().beside.least_offset) return std::nullopt;
    Named now;
    for (const Shape& shape : believed) now.names.push_back(sums.place_of(shape));
    now.names.push_back(0);
    now.left = sums.left_outside(now.names);
    BesideFinding finding = judged_beside(sums, now, {catalogue().size(), false}).back();
    if (finding.status != FindingStatus::confirmed ||
        !is_worth(finding.gain, finding.price, lens.rules().beside))
        return std::nullopt;
    believed.push_back(finding.shape);
    BesideValues values = values_beside(sums, believed).back();
    const double own_nm = part * std::abs(values.values.front().value);
    return OffsetBeside{std::move(finding), std::move(values), own_nm};
}

}  // namespace ripplenotch
