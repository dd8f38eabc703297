// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/sums.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

Sums::Sums(const Lens& lens) : lens_(lens), columns_(lens) {
    const auto& target = lens.target();
    for (const RowRange& fold : lens.ground().folds())
        target_squares_.push_back(dot(target.data() + fold.first, target.data() + fold.first, fold.count));
    for (const Shape& shape : lens.shapes()) add(shape);
}

Names Sums::parts_of(const Names& names) const {
    Names parts;
    for (const std::size_t name : names) {
        if (const auto plain = columns_.plain_of(name)) parts.push_back(*plain);
        parts.push_back(name);
    }
    return parts;
}

void Sums::add(const Shape& shape) {
    columns_.add(shape);
    const std::vector<Column>& own = columns_.own(shapes().size() - 1);
    std::vector<VectorXd> targets;
    for (const RowRange& fold : lens_.ground().folds()) {
        VectorXd sums(static_cast<Index>(own.size()));
        for (Index c = 0; c < sums.size(); ++c)
            sums[c] = dot(own[static_cast<std::size_t>(c)]->data() + fold.first,
                          lens_.target().data() + fold.first, fold.count);
        targets.push_back(std::move(sums));
    }
    targets_.push_back(std::move(targets));
}

std::vector<Sums::Column> Sums::weighed(std::size_t shape) const {
    std::vector<Column> all;
    for (const std::size_t part : parts_of({shape})) {
        const std::vector<Column>& own = columns_.own(part);
        all.insert(all.end(), own.begin(), own.end());
    }
    return all;
}

std::size_t Sums::place_of(const Shape& shape) {
    const auto known =
        std::find_if(shapes().begin(), shapes().end(), [&](const Shape& one) { return alike(one, shape); });
    if (known != shapes().end()) return static_cast<std::size_t>(known - shapes().begin());
    add(shape);
    return shapes().size() - 1;
}

void Sums::forget_but(Names& kept) {
    Names staying;
    std::vector<std::vector<VectorXd>> targets;
    for (std::size_t place = 0; place < shapes().size(); ++place) {
        if (place >= listed() && std::find(kept.begin(), kept.end(), place) == kept.end()) continue;
        staying.push_back(place);
        targets.push_back(std::move(targets_[place]));
    }
    targets_ = std::move(targets);
    columns_.keep(staying);
    std::erase_if(pairs_, [&](const auto& entry) { return entry.first.second >= listed(); });
    for (std::size_t& name : kept)
        name = static_cast<std::size_t>(std::find(staying.begin(), staying.end(), name) - staying.begin());
}

bool Sums::is_told(std::size_t shape) const {
    return columns_.part(shape) > lens_.rules().screening.least_outside;
}

const Sums::ByFold& Sums::pair(std::size_t a, std::size_t b) const {
    const auto [entry, is_new] = pairs_.try_emplace({a, b});
    if (!is_new) return entry->second;
    // Held here, whatever goes meanwhile.
    const std::vector<Column> first = columns_.own(a), second = columns_.own(b);
    for (const RowRange& fold : lens_.ground().folds()) {
        MatrixXd sums(static_cast<Index>(first.size()), static_cast<Index>(second.size()));
        const auto of = [&](const std::vector<Column>& columns, Index column) {
            return columns[static_cast<std::size_t>(column)]->data() + fold.first;
        };
        // Two by two where both have two columns or four.
        if (sums.rows() % 2 == 0 && sums.cols() % 2 == 0) {
            for (Index r = 0; r < sums.rows(); r += 2) {
                for (Index c = 0; c < sums.cols(); c += 2) {
                    double four[4] = {};
                    add_dots({of(first, r), of(first, r + 1)}, {of(second, c), of(second, c + 1)}, fold.count,
                             four);
                    sums.block<2, 2>(r, c) << four[0], four[1], four[2], four[3];
                }
            }
        } else {
            for (Index r = 0; r < sums.rows(); ++r) {
                for (Index c = 0; c < sums.cols(); ++c)
                    sums(r, c) = dot(of(first, r), of(second, c), fold.count);
            }
        }
        entry->second.push_back(std::move(sums));
    }
    return entry->second;
}

MatrixXd Sums::products(const Names& names, std::size_t fold) const {
    const Names parts = parts_of(names);
    Index size = 0;
    for (const std::size_t part : parts) size += targets_[part][0].size();
    MatrixXd all(size, size);
    for (Index a = 0, row = 0; a < static_cast<Index>(parts.size()); ++a) {
        const std::size_t first = parts[static_cast<std::size_t>(a)];
        const Index rows = targets_[first][0].size();
        for (Index b = 0, column = 0; b <= a; ++b) {
            const std::size_t second = parts[static_cast<std::size_t>(b)];
            const Index columns = targets_[second][0].size();
            if (first <= second) {
                all.block(row, column, rows, columns) = pair(first, second)[fold];
            } else {
                all.block(row, column, rows, columns) = pair(second, first)[fold].transpose();
            }
            all.block(column, row, columns, rows) = all.block(row, column, rows, columns).transpose().eval();
            column += columns;
        }
        row += rows;
    }
    return all;
}

MatrixXd Sums::products(const Names& names) const {
    MatrixXd all = products(names, 0);
    for (std::size_t fold = 1; fold < folds(); ++fold) all += products(names, fold);
    return all;
}

VectorXd Sums::targets(const Names& names, std::size_t fold) const {
    const Names parts = parts_of(names);
    Index size = 0;
    for (const std::size_t part : parts) size += targets_[part][0].size();
    VectorXd all(size);
    Index row = 0;
    for (const std::size_t part : parts) {
        const VectorXd& own = targets_[part][fold];
        all.segment(row, own.size()) = own;
        row += own.size();
    }
    return all;
}

VectorXd Sums::solved(const MatrixXd& products, const VectorXd& targets) const {
    // Sizes are drawn to 0 as little as numbers allow.
    constexpr double usual_size = 1e4, least_of_its_own = 1e-9;
    VectorXd scale = products.diagonal();
    for (Index i = 0; i < scale.size(); ++i) scale[i] = std::sqrt(scale[i] + 1e-30);
    MatrixXd scaled = products;
    VectorXd wanted = targets;
    for (Index r = 0; r < scale.size(); ++r) {
        for (Index c = 0; c < scale.size(); ++c) scaled(r, c) /= scale[r] * scale[c];
        const double drawn = lens_.sigma() / (usual_size * scale[r]);
        scaled(r, r) += drawn * drawn + least_of_its_own;
        wanted[r] /= scale[r];
    }
    return DefiniteFactors(scaled).solve(wanted).cwiseQuotient(scale);
}

double Sums::left_outside(const Names& names) const {
    double left = 0.0;
    std::vector<MatrixXd> by_fold;
    std::vector<VectorXd> target_of;
    MatrixXd all;
    VectorXd all_targets;
    for (std::size_t fold = 0; fold < folds(); ++fold) {
        by_fold.push_back(products(names, fold));
        target_of.push_back(targets(names, fold));
        if (fold == 0) {
            all = by_fold[0];
            all_targets = target_of[0];
        } else {
            all += by_fold.back();
            all_targets += target_of.back();
        }
    }
    for (std::size_t fold = 0; fold < folds(); ++fold) {
        left += target_squares_[fold];
        if (names.empty()) continue;
        const VectorXd x = solved(all - by_fold[fold], all_targets - target_of[fold]);
        left += -2.0 * x.dot(target_of[fold]) + x.dot(by_fold[fold] * x);
    }
    return left;
}

std::vector<double> Sums::residual_outside(const Names& names) const {
    return residual_outside(names, lens_.target());
}

std::vector<double> Sums::residual_outside(const Names& names, std::vector<double> target) const {
    if (names.empty()) return target;
    const MatrixXd all = products(names);
    std::vector<VectorXd> by_fold;
    VectorXd all_targets = VectorXd::Zero(all.rows());
    for (const RowRange& rows : lens_.ground().folds()) {
        VectorXd sums(all.rows());
        Index value = 0;
        for (const std::size_t name : names) {
            for (const auto& column : weighed(name))
                sums[value++] = dot(column->data() + rows.first, target.data() + rows.first, rows.count);
        }
        all_targets += sums;
        by_fold.push_back(std::move(sums));
    }
    for (std::size_t fold = 0; fold < folds(); ++fold) {
        const VectorXd x = solved(all - products(names, fold), all_targets - by_fold[fold]);
        const RowRange& rows = lens_.ground().folds()[fold];
        Index value = 0;
        for (const std::size_t name : names) {
            for (const auto& column : weighed(name))
                add_scaled(-x[value++], column->data() + rows.first, target.data() + rows.first, rows.count);
        }
    }
    return target;
}

VectorXd Sums::sizes(const Names& names) const {
    if (names.empty()) return {};
    VectorXd all_targets = targets(names, 0);
    for (std::size_t fold = 1; fold < folds(); ++fold) all_targets += targets(names, fold);
    return solved(products(names), all_targets);
}

}  // namespace ripplenotch
