// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/shape_columns.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

std::vector<ShapeColumns::Column> shared(std::vector<std::vector<double>> columns) {
    std::vector<ShapeColumns::Column> all;
    for (auto& column : columns)
        all.push_back(std::make_shared<const std::vector<double>>(std::move(column)));
    return all;
}

std::optional<std::size_t> plain_among(std::span<const Shape> listed, const Shape& shape) {
    if (!shape.ringing) return std::nullopt;
    const auto plain = std::find(listed.begin(), listed.end(), Shape{shape.term});
    if (plain == listed.end()) return std::nullopt;
    return static_cast<std::size_t>(plain - listed.begin());
}

}  // namespace

void ShapeColumns::add(const Shape& shape) {
    plain_of_.push_back(plain_among(std::span(shapes_).first(std::min(listed(), shapes_.size())), shape));
    shapes_.push_back(shape);
    Lens::Weighed own = weigh(shapes_.size() - 1);
    part_.push_back(own.part);
    columns_.push_back(shared(std::move(own.columns)));
    hold(shapes_.size() - 1);
}

Lens::Weighed ShapeColumns::weigh(std::size_t shape) const {
    const auto plain = plain_of_[shape];
    if (!plain) return lens_.weighed(shapes_[shape]);
    const Term& term = shapes_[*plain].term;
    if (plain_.term != term) plain_ = {term, lens_.thinned_nm(shapes_[*plain])};
    Lens::Weighed own = lens_.weighed_ringing(shapes_[shape], plain_.torque_nm);
    own.part = std::max(own.part, part_[*plain]);
    return own;
}

// A search refines hundreds of shapes and asks again for few: the columns that nobody asked for longest go.
void ShapeColumns::hold(std::size_t shape) const {
    constexpr double most_bytes =
        40.0 * 1024.0 * 1024.0;         // by hand, of the 256 MiB that a diagnosis may take
    constexpr std::size_t fewest = 16;  // by hand: more than a set of names
    const double bytes = 2.0 * sizeof(double) * static_cast<double>(lens_.ground().rows());
    const std::size_t most = std::max(fewest, static_cast<std::size_t>(most_bytes / bytes));
    if (shape < listed()) return;
    std::erase(held_, shape);
    held_.push_back(shape);
    for (; held_.size() > most; held_.pop_front()) columns_[held_.front()].clear();
}

const std::vector<ShapeColumns::Column>& ShapeColumns::own(std::size_t shape) const {
    if (columns_[shape].empty()) columns_[shape] = shared(weigh(shape).columns);
    hold(shape);
    return columns_[shape];
}

void ShapeColumns::keep(std::span<const std::size_t> places) {
    ShapeColumns kept(lens_);
    for (const std::size_t place : places) {
        kept.shapes_.push_back(shapes_[place]);
        kept.plain_of_.push_back(plain_of_[place]);
        kept.part_.push_back(part_[place]);
        kept.columns_.push_back(columns_[place]);
        if (kept.shapes_.size() > listed() && !columns_[place].empty())
            kept.held_.push_back(kept.shapes_.size() - 1);
    }
    shapes_ = std::move(kept.shapes_);
    plain_of_ = std::move(kept.plain_of_);
    part_ = std::move(kept.part_);
    columns_ = std::move(kept.columns_);
    held_ = std::move(kept.held_);
}

}  // namespace ripplenotch
