// SPDX-License-Identifier: MIT
#include "diagnose/judging/doubt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnose/judging/judge.hpp"
#include "diagnose/judging/residual_regions.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

struct PlaceSums {
    double samples = 0.0, left = 0.0, torque = 0.0, both = 0.0, square = 0.0;
};

// The finding's torque and the residual, a number per row that counts, in units of the white noise.
struct Torques {
    static constexpr double variance_nm2 = 1.0;
    std::vector<double> finding_nm, left_nm;
    double telling_nm2 = 0.0;    ///< sum of squares from which a torque determines its size:
                                 ///< limits::evenness::telling_deviations
    bool changes = false;        ///< in the log, be it in rows that do not count
    bool by_its_torque = false;  ///< an interval has the weight of the finding's torque in it
};

// Both whitened, so that noise of whatever colour counts alike in every sum.
Torques torques_of(const ModelBench& bench, const Model& stated, std::size_t term) {
    const auto added = bench.torque_of(stated, term);
    Torques torques;
    torques.left_nm = bench.residual(stated);
    torques.finding_nm = bench.whitened(added);
    torques.by_its_torque = stated.terms[term].effect->side != side_of(stated.terms[term]);
    const auto [low, high] = std::minmax_element(added.begin(), added.end());
    torques.changes = *high - *low > 1e-6 * std::max(std::abs(*low), std::abs(*high));
    const double deviations = limits::evenness::telling_deviations;
    torques.telling_nm2 = deviations * deviations;
    return torques;
}

// `place`: of each row; none for those that do not count.
std::vector<PlaceSums> sums_of(const Torques& torques, const std::vector<std::size_t>& place,
                               std::size_t count) {
    std::vector<PlaceSums> sums(count);
    for (std::size_t r = 0; r < place.size(); ++r) {
        if (place[r] == none) continue;
        PlaceSums& sum = sums[place[r]];
        sum.samples += 1.0;
        sum.left += torques.left_nm[r];
        sum.torque += torques.finding_nm[r];
        sum.both += torques.left_nm[r] * torques.finding_nm[r];
        sum.square += torques.finding_nm[r] * torques.finding_nm[r];
    }
    return sums;
}

// Each interval that determines a size has the same weight; for a spring that all torque passes, the weight
// of its torque: its response depends on the motion's frequency, and where it is hardly driven, other
// transients count as much.
double between(const Torques& torques, double least_sigma, const std::vector<std::size_t>& place,
               std::size_t count) {
    double off = 0.0, places = 0.0, told = 0.0;
    for (const PlaceSums& sum : sums_of(torques, place, count)) {
        const double variance = torques.variance_nm2;
        if (sum.square < torques.telling_nm2 ||
            sum.square < least_sigma * least_sigma * variance * sum.samples)
            continue;
        const double part = sum.both / sum.square;
        const double say = torques.by_its_torque ? sum.square : 1.0;
        off += say * std::max(part * part - variance / sum.square, 0.0);
        told += say;
        places += 1.0;
    }
    return places > 1.0 ? std::sqrt(off / told) : 0.0;
}

// A torque that changes only where rows do not count is a constant in those that do, which may be anything.
bool only_constant(const Torques& torques) {
    if (!torques.changes) return false;
    const PlaceSums sum = sums_of(torques, std::vector<std::size_t>(torques.finding_nm.size(), 0), 1)[0];
    return sum.square - sum.torque * sum.torque / sum.samples < torques.telling_nm2;
}

// The share from changes within intervals alone; each is weighted by how much the torque changes in it.
double share_within(const Torques& torques, double telling_deviations, const std::vector<std::size_t>& place,
                    std::size_t count) {
    double off = 0.0, all = 0.0, chance = 0.0;
    for (const PlaceSums& sum : sums_of(torques, place, count)) {
        if (sum.samples < 2.0) continue;
        const double square = sum.square - sum.torque * sum.torque / sum.samples;
        const double both = sum.both - sum.torque * sum.left / sum.samples;
        if (!(square > 0.0)) continue;
        off += both * both / square;
        all += square;
        chance += torques.variance_nm2;
    }
    if (!(all > telling_deviations * chance)) return 0.0;
    return std::sqrt(std::max(off - chance, 0.0) / all);
}

std::vector<std::size_t> by_time(const ModelBench& bench, std::size_t count) {
    const auto& time_s = bench.looked_at().motion.time_s;
    const double start_s = time_s.front(), length_s = (time_s.back() - start_s) / static_cast<double>(count);
    std::vector<std::size_t> place;
    for (const std::size_t k : bench.rows())
        place.push_back(std::min(static_cast<std::size_t>((time_s[k] - start_s) / length_s), count - 1));
    return place;
}

// Speeds in equal parts of the samples that move, each direction by itself.
std::vector<std::size_t> by_speed(const ModelBench& bench, std::size_t count) {
    const auto& velocity = bench.looked_at().motion.velocity_deg_s;
    std::vector<double> speeds;
    for (const std::size_t k : bench.rows()) {
        if (std::abs(velocity[k]) > bench.looked_at().moving_deg_s) speeds.push_back(std::abs(velocity[k]));
    }
    std::vector<double> ends;
    for (std::size_t b = 1; b < count && !speeds.empty(); ++b) {
        const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * b / count);
        std::nth_element(speeds.begin(), middle, speeds.end());
        ends.push_back(*middle);
    }
    std::vector<std::size_t> place;
    for (const std::size_t k : bench.rows()) {
        const double speed = std::abs(velocity[k]);
        const auto b =
            static_cast<std::size_t>(std::lower_bound(ends.begin(), ends.end(), speed) - ends.begin());
        const bool counts = speed > bench.looked_at().moving_deg_s && bench.looked_at().edge[k] == 0;
        place.push_back(counts ? b + (velocity[k] > 0.0 ? count : 0) : none);
    }
    return place;
}

}  // namespace

Unevenness unevenness(const ModelBench& bench, const Model& stated, std::size_t term) {
    const Torques torques = torques_of(bench, stated, term);
    if (only_constant(torques)) return {1.0, "where it changes and where it does not"};
    Unevenness worst;
    const auto compare = [&](double part, std::string_view where) {
        if (part > worst.part) worst = {part, where};
    };
    compare(between(torques, limits::evenness::least_sigma, by_time(bench, limits::evenness::times),
                    limits::evenness::times),
            "early and late in the log");
    compare(between(torques, limits::evenness::least_sigma, by_speed(bench, limits::evenness::speeds),
                    2 * limits::evenness::speeds),
            "slow and fast, both directions");
    for (const std::size_t stretches : {limits::evenness::short_stretches, limits::evenness::long_stretches})
        compare(
            share_within(torques, limits::evenness::telling_deviations, by_time(bench, stretches), stretches),
            "within short stretches of the log");
    return worst;
}

namespace {

constexpr const char* more_is_left = "the unexplained residual is larger than its share";

// Domains in which an unexplained region is a reason against an effect.
bool touches(Domain domain, const ResidualRegion& region) {
    switch (region.kind) {
        case RegionKind::order:
        case RegionKind::tone:
            return domain == Domain::order || domain == Domain::frequency;
        case RegionKind::position:
            return domain == Domain::position;
        case RegionKind::speed:
            return domain == Domain::speed;
        case RegionKind::time:
            return domain == Domain::time || domain == Domain::speed || domain == Domain::position;
    }
    return false;
}

std::string uneven_words(const Unevenness& uneven) {
    return fmt::format("what is there only looks like it: its size differs by {:.0f} % {}",
                       100.0 * std::min(uneven.part, 9.99), uneven.where);
}

// A ripple is named by its order: one whose size changes along the log is still that ripple, as long as it is
// larger than the change.
double most_uneven(const Term& term, const ModelBench& bench) {
    if (term.effect->ripple_order) return 1.0;
    const bool beside_known = bench.noise_holds_residual() && !bench.looked_at().motion.known_nm.empty();
    return beside_known ? limits::residual::most_uneven : limits::evenness::most_uneven;
}

bool is_fast(Domain d) { return d == Domain::order || d == Domain::frequency; }

bool of_one_kind(Domain a, Domain b) { return is_fast(a) == is_fast(b); }

// Delay of a slow torque by a spring without amplification, in s; empty where it amplifies.
std::optional<double> delay_of_spring(const Term& term, double most_damping) {
    const auto value = [&](std::string_view name) {
        const auto place = find_parameter(*term.effect, name);
        return place ? term.values[*place].value_or(0.0) : 0.0;
    };
    const double damping = value("damping"), hertz = value("frequency_hz");
    if (damping < most_damping || hertz <= 0.0) return std::nullopt;
    return damping / (std::numbers::pi * hertz);
}

// The shortest time of an effect of the sensor, in samples; empty when it has none.
std::optional<double> shortest_delay_samples(const Term& term, const ModelBench& bench) {
    const Case& looked_at = bench.looked_at();
    std::optional<double> shortest;
    if (const auto delay_s = delay_of_spring(term, limits::shape::most_damping))
        shortest = *delay_s * looked_at.motion.sample_rate.value();
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        if (side_of(term) != Side::sensor || parameter.unit != "s" || !term.values[p]) continue;
        const double samples = std::abs(*term.values[p]) * looked_at.motion.sample_rate.value();
        shortest = std::min(shortest.value_or(samples), samples);
    }
    return shortest;
}

// The size that is determined best, and its relative standard error.
struct Size {
    std::string_view name;
    double error = 0.0;
};

// Empty for an effect without a size; of several the first that is identifiable, or the last.
std::optional<Size> size_of(const Term& stated, const std::vector<FittedValue>& values, std::size_t term,
                            double most_error) {
    std::optional<Size> size;
    for (const FittedValue& value : values) {
        const Parameter& parameter = stated.effect->parameters[value.parameter];
        if (value.term != term || !parameter.linear) continue;
        const double off = std::abs(value.value - parameter.neutral);
        size = {parameter.name,
                value.standard_error ? *value.standard_error / off : std::numeric_limits<double>::infinity()};
        if (size->error < most_error) return size;
    }
    return size;
}

// A reason against a finding in itself; empty when there is none.
struct RaisedDoubt {
    FindingStatus status = FindingStatus::confirmed;
    std::string reason;
};

// Tests whether the standard error covers the size, unless another size of the effect is identifiable.
RaisedDoubt doubt_of_error(const Candidate& model, std::size_t term) {
    const auto size = size_of(model.stated.terms[term], model.values, term, limits::doubt::most_error);
    if (size && !(size->error < limits::doubt::most_error))
        return {FindingStatus::unidentifiable,
                fmt::format("its {} is not identifiable from this log", size->name)};
    return {};
}

// Tests whether a finding is too small to matter, or too small to be identifiable.
RaisedDoubt doubt_of_size(const ModelBench& bench, const Candidate& model, std::size_t term,
                          const Evidence& evidence) {
    const Term& stated = model.stated.terms[term];
    bool slight = !bench.noise_holds_residual() && evidence.share_sigma < bench.material_sigma();
    // Instead it has to gain in most of the log's blocks.
    if (bench.noise_holds_residual() && evidence.t < limits::residual::least_t)
        return {FindingStatus::tentative, "its gain is that of a few blocks of the log"};
    // A delay of part of a sample is within the definition of the sampling instant.
    if (const auto samples = shortest_delay_samples(stated, bench); samples && !slight)
        slight = *samples < least_delay_samples;
    if (slight)
        return {FindingStatus::immaterial,
                fmt::format("it changes the torque by {:.2g} Nm rms, with a noise of {:.2g} Nm rms",
                            evidence.share_nm, bench.noise().material_nm)};
    const double share_nm = std::max(evidence.share_nm, 1e-12);
    if (evidence.own_nm > limits::doubt::most_inflation * share_nm)
        return {
            FindingStatus::unidentifiable,
            "its torque is nearly collinear with that of another effect: this log cannot distinguish them"};
    return doubt_of_error(model, term);
}

RaisedDoubt doubt_of_kind(const ModelBench& bench, const Candidate& model, std::size_t term,
                          const Evidence& evidence) {
    if (evidence.raw_gain <= limits::doubt::least_closed_nm2)
        return {FindingStatus::tentative, "the gap is no smaller with it"};
    if (const auto bent = bent_parameter(bench, model, term); !bent.empty()) {
        return {
            FindingStatus::tentative,
            fmt::format("its {} ends at a bound, or as good as that: it stands in for something else", bent)};
    }
    if (evidence.elsewhere < limits::doubt::least_elsewhere)
        return {FindingStatus::tentative,
                "it explains one short stretch of the log and hardly anything elsewhere"};
    const Unevenness uneven = unevenness(bench, model.stated, term);
    if (uneven.part > most_uneven(model.stated.terms[term], bench))
        return {FindingStatus::tentative, uneven_words(uneven)};
    const auto above = above_wandering(bench, model.stated, term, evidence.raw_gain);
    if (above && *above < limits::wandering::least_above)
        return {FindingStatus::tentative, "the log wanders nearly as slowly, and nearly as far, without it"};
    return {};
}

}  // namespace

void doubt_alone(Finding& finding, const ModelBench& bench, const Candidate& model, std::size_t term) {
    RaisedDoubt doubt = doubt_of_size(bench, model, term, finding.evidence);
    if (doubt.status == FindingStatus::confirmed) doubt = doubt_of_kind(bench, model, term, finding.evidence);
    finding.status = doubt.status;
    finding.reason = std::move(doubt.reason);
}

bool doubt_size(Finding& finding, const Candidate& told, std::size_t term) {
    const RaisedDoubt doubt = doubt_of_error(told, term);
    if (doubt.status == FindingStatus::confirmed) return false;
    finding.status = doubt.status;
    finding.reason = doubt.reason;
    finding.values.clear();
    for (const FittedValue& value : told.values) {
        if (value.term == term) finding.values.push_back(value);
    }
    return true;
}

double excess_of(const ModelBench& bench, const Model& stated) {
    const double left_nm = rms(bench.cleared_residual(stated));
    return std::sqrt(std::max(left_nm * left_nm - portable::pow(bench.noise().rms_nm, 2), 0.0));
}

void doubt_for_residual(Finding& finding, double excess_nm, const ModelBench& bench,
                        const std::vector<ResidualRegion>& unexplained) {
    const double share_nm = finding.evidence.share_nm;
    if (excess_nm > limits::doubt::outgrown * share_nm && !unexplained.empty()) {
        finding.status = FindingStatus::tentative;
        finding.reason = more_is_left;
    }
    const ResidualRegion* largest = nullptr;
    for (const ResidualRegion& place : unexplained) {
        if (!touches(finding.term.effect->domain, place) || is_confined(place, bench.looked_at())) continue;
        if (largest == nullptr || place.rms_nm > largest->rms_nm) largest = &place;
    }
    // The residual must not be small compared with the finding to count against it.
    if (largest == nullptr || largest->rms_nm < limits::doubt::casts_doubt * share_nm) return;
    finding.status = FindingStatus::tentative;
    finding.reason = "unexplained residual remains where it acts";
}

void doubt_for_size(Finding& finding, const std::vector<Finding>& findings) {
    const Evidence& evidence = finding.evidence;
    // A parameter that acts without the size is weaker evidence: the phase of a ripple differs by direction
    // wherever the form of its resonance is not quite the catalogue's.
    const double share_nm = evidence.sized_nm < evidence.own_nm
                                ? std::min(evidence.share_nm, evidence.sized_nm)
                                : evidence.share_nm;
    const double share_sigma = evidence.share_sigma * share_nm / std::max(evidence.share_nm, 1e-12);
    for (const Finding& other : findings) {
        if (&other == &finding) continue;
        const Effect& larger = *other.term.effect;
        const bool slight = share_sigma < limits::doubt::slight_sigma;
        const bool stands = share_sigma > limits::doubt::stands_sigma &&
                            evidence.own_nm > limits::doubt::shape_part * other.evidence.own_nm;
        const double larger_nm = std::max(other.evidence.share_nm, other.evidence.own_nm);
        if (share_nm > limits::doubt::shape_part * larger_nm || stands ||
            !(slight || of_one_kind(finding.term.effect->domain, larger.domain)))
            continue;
        finding.status = is_doubtful(other) ? FindingStatus::tentative : FindingStatus::shape_correction;
        finding.reason = fmt::format("it may only correct the form of {}, which is {}", larger.name,
                                     is_doubtful(other) ? "in doubt" : "far larger");
    }
}

bool is_trusted(const Finding& finding) {
    return finding.status == FindingStatus::confirmed || finding.status == FindingStatus::ambiguous;
}

bool is_doubtful(const Finding& finding) {
    return finding.status == FindingStatus::tentative || finding.status == FindingStatus::unidentifiable ||
           finding.status == FindingStatus::not_reproduced;
}

bool doubt_beside(const ModelBench& bench, const Candidate& kept, std::size_t own_terms,
                  std::vector<Finding>& findings) {
    const double excess_nm = excess_of(bench, kept.stated);
    bool changed = false;
    std::size_t term = own_terms;
    for (Finding& finding : findings) {
        if (is_doubtful(finding)) continue;
        const std::size_t place = term++;
        const Domain domain = finding.term.effect->domain;
        bool same = false, kin = false;
        for (const Finding& other : findings) {
            same = same || (is_doubtful(other) && other.term.effect->domain == domain);
            kin = kin || (is_doubtful(other) && is_fast(other.term.effect->domain) && is_fast(domain));
        }
        if (!is_trusted(finding)) continue;
        const Unevenness uneven = same ? unevenness(bench, kept.stated, place) : Unevenness{};
        const double share_nm = finding.evidence.share_nm;
        const bool outdone = (same || kin) && excess_nm > limits::doubt::outgrown * share_nm;
        if (!outdone && uneven.part <= most_uneven(finding.term, bench)) continue;
        finding.status = FindingStatus::tentative;
        finding.reason = outdone ? more_is_left : uneven_words(uneven);
        changed = true;
    }
    return changed;
}

}  // namespace ripplenotch
