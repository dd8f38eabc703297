// SPDX-License-Identifier: MIT
#include "diagnose/engine/criterion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/vectors/dot.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

constexpr double refused_squares = 1e15;
constexpr double no_prior = std::numeric_limits<double>::infinity();
constexpr double most_scale_log = 1.1;  // a torque off by a factor of three
// Of a block: longer than what remains correlated after whitening, short enough for many blocks.
constexpr double block_s = 1.0;
constexpr std::size_t fold_count = 8;  // groups of blocks that are left out in turn
// Windows that are one measurement to a slowly changing column: as of the fit of the arm, whose other joints
// are the prior.
constexpr double memory_s = 0.05;
constexpr std::size_t fewest_block_samples = 50, fewest_blocks = 40;
constexpr std::size_t most_held_numbers = 16'000'000;  // of columns in memory: 128 MB

// Groups of columns besides those of the terms.
enum Group { of_term = 0, target = 1, base_column = 2, ripple_before_joint = 3, ripple_behind_joint = 4 };

Blocks make_blocks(const RecordedMotion& recorded, std::size_t memory) {
    const std::size_t count = recorded.size();
    const double duration_s = static_cast<double>(count) * recorded.step_s();
    const double length_s = std::min(block_s, duration_s / static_cast<double>(fewest_blocks));
    const std::size_t length =
        std::max(fewest_block_samples, static_cast<std::size_t>(length_s / recorded.step_s()));
    Blocks blocks{{}, {0}};
    // The whitening filter must not reach samples that do not count.
    std::size_t good_before = 0;
    for (std::size_t block = 0; block < count / length; ++block) {
        std::vector<std::size_t> samples;
        for (std::size_t k = block * length; k < (block + 1) * length; ++k) {
            if (recorded.usable()[k] != 0 && good_before >= memory) samples.push_back(k);
            good_before = recorded.usable()[k] != 0 ? good_before + 1 : 0;
        }
        if (samples.size() <= length / 4) continue;
        blocks.sample.insert(blocks.sample.end(), samples.begin(), samples.end());
        blocks.first.push_back(blocks.sample.size());
    }
    return blocks;
}

// Squares of the residual of these factors, from products with the target first.
double squares_left(const VectorXd& factors, const MatrixXd& gram) {
    const Index count = factors.size();
    if (count == 0) return gram(0, 0);
    return gram(0, 0) - 2.0 * factors.dot(gram.col(0).tail(count)) +
           factors.dot(gram.bottomRightCorner(count, count) * factors);
}

}  // namespace

ColumnProducts::ColumnProducts(const Blocks& blocks, std::vector<double> filter, double unit_nm)
    : blocks_(blocks), filter_(std::move(filter)), unit_nm_(unit_nm) {}

void ColumnProducts::pack(int place, std::vector<double> whole) {
    if (filter_.size() > 1) filter_in_place(whole, filter_);
    auto& values = columns_[static_cast<std::size_t>(place)].values;
    values.resize(blocks_.sample.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = whole[blocks_.sample[i]] / unit_nm_;
    held_ += values.size();
}

// The columns used longest ago are computed anew if they are needed again; their products stay.
void ColumnProducts::release_old() {
    if (held_ <= most_held_numbers) return;
    std::vector<std::uint64_t> ages;
    for (const Kept& kept : columns_)
        if (!kept.values.empty()) ages.push_back(kept.last_use);
    const auto middle = ages.begin() + static_cast<std::ptrdiff_t>(ages.size() / 2);
    std::nth_element(ages.begin(), middle, ages.end());
    const std::uint64_t oldest_kept = *middle;
    for (Kept& kept : columns_) {
        if (kept.values.empty() || kept.last_use >= oldest_kept) continue;
        held_ -= kept.values.size();
        kept.values = {};
    }
}

const std::vector<int>& ColumnProducts::places(const Key& key, const Make& make) {
    const auto [entry, is_new] = places_.try_emplace(key);
    if (!is_new) return entry->second;
    release_old();
    auto whole = make();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const int place = static_cast<int>(columns_.size());
        columns_.push_back({.values = {}, .make = make, .of_group = i, .last_use = ++uses_});
        pack(place, std::move(whole[i]));
        entry->second.push_back(place);
    }
    return entry->second;
}

std::span<const double> ColumnProducts::column(int place) {
    Kept& kept = columns_[static_cast<std::size_t>(place)];
    if (kept.values.empty()) pack(place, std::move(kept.make()[kept.of_group]));
    kept.last_use = ++uses_;
    return kept.values;
}

std::span<const double> ColumnProducts::products(int a, int b) {
    const auto low = static_cast<std::uint64_t>(std::min(a, b));
    const auto high = static_cast<std::uint64_t>(std::max(a, b));
    const auto [entry, is_new] = sums_place_.try_emplace(high << 32U | low, sums_.size());
    if (is_new) {
        const std::span<const double> x = column(a), y = column(b);
        for (std::size_t block = 0; block < blocks_.count(); ++block) {
            const std::size_t from = blocks_.first[block];
            sums_.push_back(dot(&x[from], &y[from], blocks_.first[block + 1] - from));
        }
    }
    return {sums_.data() + entry->second, blocks_.count()};
}

Criterion::Criterion(const RecordedMotion& recorded, const Baseline& base,
                     std::shared_ptr<const SaturatedFit> noise)
    : recorded_(recorded),
      base_(base),
      noise_(std::move(noise)),
      blocks_(make_blocks(recorded, noise_->whitening.size())),
      white_(blocks_, noise_->whitening, noise_->innovation_nm),
      plain_(blocks_, {1.0}, 1.0) {}

std::vector<std::vector<double>> Criterion::term_columns(const SearchedTerm& term,
                                                         const MotorAngle& angle) const {
    const GearRatio ratio = angle.ratio;
    const Motion& motion = recorded_.motion();
    if (term.kind->role != Role::ripple_change) {
        const Effect& effect = *term.kind->effect;
        if (effect.ripple_order && !angle.errors.empty())
            return unit_columns(effect, unit_values(term),
                                {.motion = without_errors(motion, angle.errors), .ratio = ratio});
        return unit_columns(effect, unit_values(term),
                            {.motion = motion, .ratio = ratio, .load_nm = noise_->load_nm});
    }
    const Situation situation{.motion = motion, .ratio = ratio, .load_nm = noise_->sensed_nm};
    std::vector<std::vector<double>> columns;
    for (const auto& factor : ripple_factors(term, situation)) {
        // A modulation is one of the fitted ripple as a whole; other changes are each order's own.
        auto waves = term.kind->effect->polar ? std::vector<std::vector<double>>{noise_->ripple_nm}
                                              : ripple_waves(angle);
        for (auto& wave : waves) {
            for (std::size_t k = 0; k < wave.size(); ++k) wave[k] *= factor[k];
            columns.push_back(std::move(wave));
        }
    }
    return columns;
}

std::vector<std::vector<double>> Criterion::ripple_waves(const MotorAngle& angle) const {
    const Motion& motion = recorded_.motion();
    if (angle.errors.empty()) return base_.ripple_waves(motion, angle.ratio);
    return base_.ripple_waves(without_errors(motion, angle.errors), angle.ratio);
}

Design Criterion::design(const SearchedTerms& terms, ColumnProducts& columns, const Parts& parts) {
    const Motion& motion = recorded_.motion();
    SearchedTerms with_stated = base_.stated;
    with_stated.insert(with_stated.end(), terms.begin(), terms.end());
    const Transforms transforms(with_stated);
    const SearchedTerms every = transforms.all();
    const MotorAngle angle = motor_angle(with_stated, base_.ratio), fixed{base_.ratio, {}};
    Design made;
    const auto add = [&](const SearchedTerm& term, int group, const SearchedTerms& behind,
                         const MotorAngle& at, auto make) {
        const ColumnProducts::Key key{term, group, at.ratio.value(), at.errors, behind};
        const auto& places = columns.places(key, [make, behind, &motion] {
            auto whole = make();
            for (auto& column : whole) column = transformed(std::move(column), behind, motion);
            return whole;
        });
        made.columns.insert(made.columns.end(), places.begin(), places.end());
        made.deviation.resize(made.columns.size(), no_prior);
    };
    // The torque less what is known, as the sensor sees that.
    const SearchedTerms behind_known = base_.known_nm.empty() ? SearchedTerms{} : every;
    made.target = columns.places({{}, target, 0.0, {}, behind_known}, [this, behind_known, &motion] {
        std::vector<double> torque = recorded_.torque_nm();
        if (!base_.known_nm.empty()) {
            const std::vector<double> known = transformed(base_.known_nm, behind_known, motion);
            add_scaled(-1.0, known.data(), torque.data(), torque.size());
        }
        return std::vector<std::vector<double>>{torque};
    })[0];
    for (std::size_t i = 0; i < base_.columns.size(); ++i) {
        if (base_.columns[i].has_prior() && !parts.nuisance) continue;
        const SearchedTerm place{nullptr, {static_cast<double>(i), 0.0}};
        add(place, base_column, every, {},
            [this, i] { return std::vector<std::vector<double>>{base_.columns[i].torque_nm}; });
        made.deviation.back() = base_.columns[i].deviation;
    }
    const auto ripple = [this, angle] { return ripple_waves(angle); };
    const bool has_ripple = !base_.orders.empty() && parts.ripple == Ripple::fitted;
    if (has_ripple) {
        add({}, ripple_before_joint, every, angle, ripple);
        // The gauges' own ripple does not pass the elastic joint.
        if (!transforms.elastic_joint.empty()) add({}, ripple_behind_joint, transforms.sensor, angle, ripple);
    }
    for (const SearchedTerm& term : terms) {
        made.first_of_term.push_back(made.columns.size());
        const Role role = term.kind->role;
        const bool has_columns =
            role == Role::joint_torque || role == Role::sensor_torque || role == Role::ripple_change;
        if (!has_columns || (term.changes_ripple() && parts.ripple == Ripple::left)) continue;
        const bool turns_with_motor = term.kind->effect->ripple_order || term.changes_ripple();
        add(term, of_term, role == Role::sensor_torque ? SearchedTerms{} : every,
            turns_with_motor ? angle : fixed, [this, term, angle] { return term_columns(term, angle); });
    }
    return made;
}

MatrixXd Criterion::gram(const Design& design, ColumnProducts& columns, std::vector<MatrixXd>* by_block) {
    std::vector<int> all = {design.target};
    all.insert(all.end(), design.columns.begin(), design.columns.end());
    const auto size = static_cast<Index>(all.size());
    MatrixXd sum = MatrixXd::Zero(size, size);
    if (by_block) by_block->assign(blocks_.count(), MatrixXd::Zero(size, size));
    for (Index i = 0; i < size; ++i) {
        for (Index j = 0; j <= i; ++j) {
            const auto products =
                columns.products(all[static_cast<std::size_t>(i)], all[static_cast<std::size_t>(j)]);
            for (std::size_t block = 0; block < products.size(); ++block) {
                sum(i, j) += products[block];
                if (by_block) (*by_block)[block](i, j) = (*by_block)[block](j, i) = products[block];
            }
            sum(j, i) = sum(i, j);
        }
    }
    return sum;
}

std::vector<double> Criterion::prior_weights(const Design& design, const MatrixXd& gram,
                                             double noise_nm) const {
    std::vector<double> weights;
    for (std::size_t c = 0; c < design.columns.size(); ++c) {
        const double deviation = design.deviation[c];
        const double power = std::max(gram(static_cast<Index>(c) + 1, static_cast<Index>(c) + 1), 1e-300);
        weights.push_back(ridge);
        if (deviation < no_prior) weights.back() += noise_nm * noise_nm / (deviation * deviation * power);
    }
    return weights;
}

// What changes a friction needs one; what rings does so for some cycles.
bool Criterion::is_possible(const SearchedTerms& terms) const {
    const auto is_there = [&](std::string_view name) {
        return contains(terms, name) || base_.has(name) || base_.states(name) || base_.is_simulated;
    };
    for (const SearchedTerm& term : terms) {
        const bool changes_friction = term.is("position-dependent-friction") || term.is("friction-warm-up") ||
                                      term.is("asymmetric-friction") || term.is("backlash");
        if (changes_friction && !is_there("coulomb-friction") && !is_there("hysteresis")) return false;
        if (term.is("asymmetric-viscous-friction") && !is_there("viscous-friction")) return false;
        if (term.is("position-dependent-friction")) {
            // Twice a turn the load of a weight comes and goes, and friction with it.
            const bool is_by_load = term.values[0] == 2.0 && is_there("gravity") && !base_.is_simulated;
            if (is_by_load || recorded_.travel_deg() * term.values[0] < 180.0) return false;
        }
        // Of what can be lifted the weight is known first.
        if (term.is("payload-change") && !is_there("gravity")) return false;
        if (term.is("start-stop-ringing") && term.values[0] * term.values[1] < fewest_cycles) return false;
    }
    return true;
}

const LinearFit& Criterion::fit(const SearchedTerms& given) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    const auto [entry, is_new] = fits_.try_emplace(terms);
    LinearFit& found = entry->second;
    if (!is_new) return found;
    const Design made = design(terms, white_, {});
    const MatrixXd products = gram(made, white_, nullptr);
    const std::vector<double> weights = prior_weights(made, products, 1.0);
    found.factors = solve_normal_equations(products, weights);
    found.squares = squares_left(found.factors, products);
    for (std::size_t c = 0; c < weights.size(); ++c) {
        const double factor = found.factors[static_cast<Index>(c)];
        const double power = products(static_cast<Index>(c) + 1, static_cast<Index>(c) + 1);
        found.squares += (weights[c] - ridge) * factor * factor * power;
    }
    if (!is_possible(terms)) found.is_physical = false;
    if (!terms.empty() && !base_.columns.empty() && base_.columns.front().name == "simulated") {
        // The simulation's size does not hang on a term: its inertia and a term's would cancel, to leave what
        // neither regression holds.
        const auto off = [](double scale) {
            return scale > 0.0 ? std::abs(portable::log(scale)) : std::numeric_limits<double>::infinity();
        };
        if (off(found.factors[0]) > std::max(most_scale_log, off(fit({}).factors[0])))
            found.is_physical = false;
    }
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const Effect& effect = *terms[i].kind->effect;
        // Nothing that resists drives the joint, unless the user states more of it or a simulation may hold
        // more.
        const bool may_drive =
            base_.states(effect.name) ||
            (base_.is_simulated && (effect.name == "coulomb-friction" || effect.name == "viscous-friction"));
        if (!effect.resists || may_drive) continue;
        std::size_t column = made.first_of_term[i];
        for (const Parameter& parameter : effect.parameters)
            if (parameter.linear && found.factors[static_cast<Index>(column++)] < 0.0)
                found.is_physical = false;
    }
    if (!found.is_physical) found.squares = refused_squares;
    return found;
}

const BlockSquares& Criterion::block_squares(const SearchedTerms& given) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    const auto [entry, is_new] = block_squares_.try_emplace(terms);
    BlockSquares& found = entry->second;
    if (!is_new) return found;
    const LinearFit& whole = fit(terms);
    const Design made = design(terms, white_, {});
    std::vector<MatrixXd> by_block;
    const MatrixXd products = gram(made, white_, &by_block);
    const std::vector<double> weights = prior_weights(made, products, 1.0);
    for (const MatrixXd& block : by_block) found.fitted.push_back(squares_left(whole.factors, block));
    found.held_out.resize(by_block.size());
    for (std::size_t fold = 0; fold < fold_count; ++fold) {
        MatrixXd rest = products;
        for (std::size_t block = fold; block < by_block.size(); block += fold_count) rest -= by_block[block];
        const VectorXd factors = solve_normal_equations(rest, weights);
        for (std::size_t block = fold; block < by_block.size(); block += fold_count)
            found.held_out[block] = squares_left(factors, by_block[block]);
    }
    const std::size_t stretches = std::min(by_block.size(), most_stretches);
    const VectorXd unit = products.diagonal().tail(whole.factors.size()).cwiseSqrt();
    found.without_stretch.resize(unit.size(), static_cast<Index>(stretches));
    for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
        MatrixXd rest = products;
        for (std::size_t block = stretch * by_block.size() / stretches;
             block < (stretch + 1) * by_block.size() / stretches; ++block)
            rest -= by_block[block];
        found.without_stretch.col(static_cast<Index>(stretch)) =
            solve_normal_equations(rest, weights).cwiseProduct(unit);
    }
    return found;
}

double Criterion::size_t_value(const SearchedTerms& given, const SearchedTerm& term) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    const MatrixXd& all = block_squares(terms).without_stretch;
    const auto place = static_cast<std::size_t>(std::ranges::find(terms, term) - terms.begin());
    const std::vector<std::size_t> first = design(terms, white_, {}).first_of_term;
    const auto from = static_cast<Index>(first[place]);
    const Index end = place + 1 < first.size() ? static_cast<Index>(first[place + 1]) : all.rows();
    if (from == end) return 0.0;
    const MatrixXd own = all.middleRows(from, end - from);
    const VectorXd mean = own.rowwise().mean();
    const VectorXd along = own.transpose() * mean.normalized();
    const auto count = static_cast<double>(along.size());
    const double spread = (along.array() - along.mean()).square().sum() * (1.0 - 1.0 / count);
    return mean.norm() / (std::sqrt(spread) + 1e-300);
}

double Criterion::cost(const SearchedTerms& terms) {
    std::size_t numbers = 0;
    for (const SearchedTerm& term : terms) numbers += fitted_values(term, base_.orders.size());
    return fit(terms).squares + penalty_per_value * static_cast<double>(numbers);
}

const std::vector<double>& Criterion::plain_block_squares(const SearchedTerms& given) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    const auto [entry, is_new] = plain_squares_.try_emplace(terms);
    if (!is_new) return entry->second;
    const Design made = design(terms, plain_, {.nuisance = false});
    std::vector<MatrixXd> by_block;
    const MatrixXd products = gram(made, plain_, &by_block);
    const VectorXd factors =
        solve_normal_equations(products, prior_weights(made, products, noise_->noise_nm));
    for (const MatrixXd& block : by_block) entry->second.push_back(squares_left(factors, block));
    return entry->second;
}

std::vector<double> Criterion::residual_nm(const SearchedTerms& given, Ripple ripple) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    const Design made = design(terms, plain_, {.ripple = ripple});
    const MatrixXd products = gram(made, plain_, nullptr);
    const VectorXd factors =
        solve_normal_equations(products, prior_weights(made, products, noise_->noise_nm));
    const std::span<const double> torque = plain_.column(made.target);
    std::vector<double> packed(torque.begin(), torque.end());
    for (std::size_t c = 0; c < made.columns.size(); ++c)
        add_scaled(-factors[static_cast<Index>(c)], plain_.column(made.columns[c]).data(), packed.data(),
                   packed.size());
    std::vector<double> residual(recorded_.size(), 0.0);
    for (std::size_t i = 0; i < packed.size(); ++i) residual[blocks_.sample[i]] = packed[i];
    return residual;
}

VectorXd Criterion::settled_factors(const SearchedTerms& given) {
    SearchedTerms terms = given;
    std::sort(terms.begin(), terms.end());
    VectorXd factors = fit(terms).factors;
    const Design made = design(terms, plain_, {});
    std::vector<Index> known;
    for (std::size_t c = 0; c < base_.columns.size(); ++c) {
        // No model holds them.
        if (base_.columns[c].name == "nuisance")
            factors[static_cast<Index>(c)] = 0.0;
        else if (base_.columns[c].has_prior())
            known.push_back(static_cast<Index>(c));
    }
    if (known.empty()) return factors;
    const std::span<const double> torque = plain_.column(made.target);
    std::vector<double> residual(torque.begin(), torque.end());
    for (std::size_t c = 0; c < made.columns.size(); ++c)
        add_scaled(-factors[static_cast<Index>(c)], plain_.column(made.columns[c]).data(), residual.data(),
                   residual.size());
    const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(memory_s / recorded_.step_s()));
    double squares = 0.0;
    for (std::size_t k = 0; k + length <= residual.size(); k += length) {
        const double sum = std::accumulate(&residual[k], &residual[k] + length, 0.0);
        squares += sum * sum;
    }
    const MatrixXd products = gram(made, plain_, nullptr);
    const std::vector<double> weights = prior_weights(made, products, std::sqrt(squares / samples()));
    for (const Index c : known) factors[c] = 0.0;
    // Products of the known columns with the torque less all others, and with each other.
    const auto size = static_cast<Index>(known.size());
    MatrixXd among(size + 1, size + 1);
    std::vector<double> priors;
    for (Index a = 0; a < size; ++a) {
        const Index column = known[static_cast<std::size_t>(a)];
        priors.push_back(weights[static_cast<std::size_t>(column)]);
        among(a + 1, 0) =
            products(column + 1, 0) - products.row(column + 1).tail(factors.size()).dot(factors);
        for (Index b = 0; b < size; ++b)
            among(a + 1, b + 1) = products(column + 1, known[static_cast<std::size_t>(b)] + 1);
    }
    const VectorXd found = solve_normal_equations(among, priors);
    for (Index a = 0; a < size; ++a) factors[known[static_cast<std::size_t>(a)]] = found[a];
    return factors;
}

double Criterion::rms_nm(const SearchedTerms& terms) {
    const std::vector<double> residual = residual_nm(terms);
    return std::sqrt(dot(residual.data(), residual.data(), residual.size()) / samples());
}

}  // namespace ripplenotch::engine
