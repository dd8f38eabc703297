// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/given_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/text/lower_case.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

constexpr Key file_key{.name = "file", .kind = KeyKind::text, .required = true, .help = "the description"};
constexpr Key tip_key{.name = "tip", .kind = KeyKind::text, .help = "the link at which the chain ends"};
constexpr Key gravity_key{
    .name = "gravity", .kind = KeyKind::list, .help = "in m/s2, in the frame of the base: 0:0:-9.81"};
constexpr Key joints_key{.name = "joints",
                         .kind = KeyKind::text,
                         .help = "NAME:NAME IN THE LOG, NAME:=0deg for one that is still"};
constexpr Key word_key{
    .name = "word", .kind = KeyKind::text, .required = true, .help = "a letter a joint: x y z X Y Z"};
constexpr Key length_key{
    .name = "length", .kind = KeyKind::text, .default_text = "0.3m", .help = "of all links"};

constexpr std::array described = {file_key, tip_key, gravity_key, joints_key};
constexpr std::array tabled = {file_key, gravity_key, joints_key};
constexpr std::array guessed = {word_key, length_key, gravity_key, joints_key};

struct Source {
    std::string_view name;
    std::span<const Key> keys;
    Chain (*read)(const Settings& settings);
};

std::optional<std::string> tip_of(const Settings& settings) {
    if (!settings.has("tip")) return std::nullopt;
    return settings.text("tip");
}

double in_metres(std::string text, std::string_view what) {
    if (text.ends_with("m")) text.pop_back();
    return parse_quantity(text, Dimension::none, what);
}

template <Chain (*of)(const std::string&, std::string_view, const std::optional<std::string>&)>
Chain of_description(const Settings& settings) {
    const std::string file = settings.text("file");
    return of(file, read_chain_file(file), tip_of(settings));
}

template <Chain (*of)(const std::string&, std::string_view)>
Chain of_table(const Settings& settings) {
    const std::string file = settings.text("file");
    return of(file, read_chain_file(file));
}

Chain of_axes(const Settings& settings) {
    return chain_of_axes(settings.text("word"), in_metres(settings.text("length"), "--arm axes, length"));
}

constexpr std::array<Source, 5> sources = {Source{"urdf", described, of_description<chain_of_urdf>},
                                           {"mjcf", described, of_description<chain_of_mjcf>},
                                           {"mdh", tabled, of_table<chain_of_mdh>},
                                           {"dh", tabled, of_table<chain_of_dh>},
                                           {"axes", guessed, of_axes}};

const Source& source_of(const std::string& name) {
    for (const Source& source : sources)
        if (source.name == name) return source;
    raise<UsageError>(
        "--arm: '{}' is none of urdf, mjcf, mdh, dh, axes; for example --arm urdf,file=robot.urdf{}", name,
        name.ends_with(".urdf") || name.ends_with(".xml") ? ", where the file is named with file=" : "");
}

// "a:1|b:2|c:=90deg"
void take_joint(std::string_view piece, ArmSource& option) {
    const std::size_t colon = piece.find(':');
    if (colon == std::string_view::npos || colon == 0 || colon + 1 == piece.size()) {
        raise<UsageError>(
            "--arm, joints: '{}' is neither NAME:NAME IN THE LOG nor NAME:=0deg; several are parted by |",
            piece);
    }
    const std::string name(piece.substr(0, colon)), partner(piece.substr(colon + 1));
    if (partner.front() != '=') {
        option.stated.emplace_back(name, partner);
        return;
    }
    const std::string what = fmt::format("--arm, joints, {}", name), position = partner.substr(1);
    const auto place = option.chain.find(name);
    const bool slides = place && option.chain.joints[*place].kind == JointKind::prismatic;
    option.chain =
        hold_joint(option.chain, name,
                   slides ? in_metres(position, what) : parse_quantity(position, Dimension::angle, what));
}

}  // namespace

ArmSource read_arm_source(std::string_view words) {
    const Spec spec = parse_spec(words);
    const Source& source = source_of(spec.name);
    const Settings settings(fmt::format("--arm {}", spec.name), spec, source.keys);
    ArmSource option{source.read(settings), {}, spec.text()};
    if (settings.has("file")) option.file = settings.text("file");
    if (settings.has("gravity")) {
        const std::vector<double> gravity = settings.list("gravity");
        if (gravity.size() != 3)
            raise<UsageError>("--arm, gravity: {} numbers, expected 3, for example 0:0:-9.81",
                              gravity.size());
        option.chain.gravity_m_s2 = {gravity[0], gravity[1], gravity[2]};
        settle_chain(option.chain);
    }
    if (!settings.has("joints")) return option;
    const std::string joints = settings.text("joints");
    for (std::string_view rest = joints;;) {
        const std::size_t bar = rest.find('|');
        take_joint(rest.substr(0, bar), option);
        if (bar == std::string_view::npos) return option;
        rest.remove_prefix(bar + 1);
    }
}

ArmLog ArmReading::view() const {
    ArmLog arm;
    for (const Log& log : logs) {
        arm.joints.push_back(log.trace.view());
        arm.has_torque.push_back(log.layout.chosen.torque.has_value());
    }
    return arm;
}

std::size_t ArmReading::find(const Chain& chain, const std::string& joint) const {
    for (std::size_t j = 0; j < names.size(); ++j)
        if (lower_case(names[j]) == lower_case(joint)) return j;
    std::vector<std::string> known;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        known.push_back(chain.joints[j].name);
        if (lower_case(known.back()) == lower_case(joint)) return j;
    }
    raise<UsageError>("arm: '{}' is no joint of {}; {}{}", joint, chain.source, joint_list(chain),
                      did_you_mean(joint, known));
}

namespace {

// Of a log with more than `most_rows` the pieces of read_log_in_part. Throws what
// read_joints_at_once and match_joints throw, and UsageError where a joint of the chain has no
// position.
ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                    const Chain& chain, const StatedJoints& stated) {
    ReadOptions motion = options;
    motion.torque_of_each = false;
    std::vector<Log> all = read_joints_at_once(path, motion, most_rows);
    std::vector<std::string> there;
    for (const Log& log : all) there.push_back(log.trace.joint);
    const std::string source = all.front().layout.source;
    ArmReading reading{{}, match_joints(chain, there, stated, source), {}};
    for (const std::size_t place : reading.match.of) {
        if (!all[place].trace.view().has_position()) {
            raise<UsageError>(
                "arm: {} has the velocity of '{}' and not its position; gravity depends on it, and the "
                "integrated velocity does not determine the start position",
                source, there[place]);
        }
        reading.names.push_back(there[place]);
        reading.logs.push_back(std::move(all[place]));
    }
    return reading;
}

double deviation(std::span<const double> values) {
    double mean = 0.0, squares = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

GivenArm::GivenArm(ArmSource option, const std::string& path, const ReadOptions& options,
                   std::optional<Seconds> smoothing, std::size_t most_rows)
    : option_(std::move(option)),
      smoothing_(smoothing),
      max_rows_(most_rows),
      reading_(read_arm(path, options, most_rows, option_.chain, option_.stated)),
      travel_(arm_travel(option_.chain, reading_.view(), reading_.names)) {}

const ArmReading& GivenArm::other(const std::string& path, const ReadOptions& options) {
    const auto known = others_.find(path);
    if (known != others_.end()) return known->second;
    ArmReading other = read_arm(path, options, max_rows_, option_.chain, option_.stated);
    (void)arm_travel(option_.chain, other.view(), other.names);
    return others_.emplace(path, std::move(other)).first->second;
}

ArmFitOptions GivenArm::options_for(std::size_t joint) const {
    ArmFitOptions options;
    options.smoothing = smoothing_;
    if (chain().lengths_are_guessed) options.joints = {joint};
    return options;
}

const GivenArm::Fitted& GivenArm::fitted(std::size_t joint) {
    const std::size_t key = chain().lengths_are_guessed ? joint : 0;
    const auto made = fits_.find(key);
    if (made != fits_.end()) return made->second;
    const ArmFitOptions options = options_for(joint);
    const ArmLog log = reading_.view();
    Fitted found{fit_arm(chain(), log, options), {}, {}};
    found.faults = suspect_arm(chain(), log, found.fit, options);
    // With a wrong set-up a delay would be of the wrong arm.
    if (found.faults.empty()) found.lag = common_lag(chain(), log, found.fit, options);
    if (found.lag && is_applied(*found.lag))
        found.fit = fit_arm(chain(), AdvancedLog(log, found.lag->delay_s).log, options);
    return fits_.emplace(key, std::move(found)).first->second;
}

bool GivenArm::is_applied(const ArmLag& lag) const {
    // The rule of a delay that is found in one joint holds here, too: a shorter one is a matter of when a
    // sample is said to be taken.
    const double period_s = 1.0 / reading_.view().joints.front().sample_rate.value();
    return lag.is_there() && std::abs(lag.delay_s) >= least_delay_samples * period_s;
}

const ArmFit& GivenArm::fit(std::size_t joint) { return fitted(joint).fit; }

const std::vector<SetupFault>& GivenArm::setup_faults(std::size_t joint) { return fitted(joint).faults; }

const GivenArm::Remaining& GivenArm::remaining(std::size_t joint) {
    const auto [entry, is_new] = remaining_.try_emplace(joint);
    Remaining& left = entry->second;
    if (!is_new) return left;
    const Fitted& found = fitted(joint);
    const bool moves = found.lag && is_applied(*found.lag);
    const AdvancedLog moved(reading_.view(), moves ? found.lag->delay_s : 0.0);
    left.log = {reading_.logs[joint]};
    std::vector<double>& torque_nm = left.log.front().trace.torque_nm;
    const std::vector<double> arm_nm = fitted_torque(chain(), found.fit, moved.log, joint);
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] = moved.log.joints[joint].torque_nm[k] - arm_nm[k];
    left.found = identify_readings(left.log, {});
    return left;
}

MapFit GivenArm::ripple(std::size_t joint, GearRatio ratio) {
    OtherMotors others;
    for (std::size_t j = 0; j < chain().size(); ++j) {
        if (j == joint || fit(joint).find(j) == nullptr) continue;
        ++others.looked_at;
        if (const auto gear = gear_of_motor(remaining(j).found, {ratio, {}}))
            others.motors.push_back({reading_.names[j], *gear, {reading_.logs[j].trace.view()}});
    }
    // Lines with the teeth of the gear are of other things.
    GearAccount own{ratio, {}, {}, {}, "--gear-ratio"};
    if (const auto gear = gear_of_motor(remaining(joint).found, {ratio, {}}))
        std::ranges::copy_if(gear->orders, std::back_inserter(own.orders),
                             [](Order order) { return order.value() == std::round(order.value()); });
    if (own.orders.empty()) own.orders = default_orders();
    return map_readings(remaining(joint).log, own, Degrees(0.0), others);
}

GivenTerm GivenArm::term(std::size_t joint, const ArmReading& log) {
    const ArmFit& found = fit(joint);
    const ArmLog view = log.view();
    return arm_term(chain(), found, view, joint, ArmKnowledge::other_joints, {},
                    motions(log, found.smoothing));
}

const std::vector<Motion>& GivenArm::motions(const ArmReading& log, Seconds smoothing) {
    std::vector<Motion>& found = motions_[{&log, smoothing.value()}];
    if (found.empty()) found = arm_motions(log.view(), smoothing);
    return found;
}

std::vector<std::vector<double>> GivenArm::others_deg_s(std::size_t joint, const ArmReading& log) {
    std::vector<std::vector<double>> velocities(chain().size());
    for (std::size_t j = 0; j < velocities.size(); ++j)
        if (j != joint && chain().joints[j].kind == JointKind::revolute)
            velocities[j] = motions(log, default_smoothing)[j].velocity_deg_s;
    return velocities;
}

ArmAccount GivenArm::stated_account(std::size_t joint, Seconds smoothing) const {
    ArmAccount account;
    account.source = chain().source;
    account.rule = reading_.match.rule;
    account.option = reading_.match.option;
    account.joints = travel_;
    account.values_are_stated = true;
    account.lengths_are_guessed = chain().lengths_are_guessed;
    account.smoothing = smoothing;
    account.gap_before_nm = deviation(reading_.logs[joint].trace.torque_nm);
    account.warnings = reading_.match.warnings;
    account.notes = reading_.match.notes;
    return account;
}

ArmAccount GivenArm::account(std::size_t joint) {
    const ArmFit& found = fit(joint);
    ArmAccount account = stated_account(joint, found.smoothing);
    account.values_are_stated = false;
    account.values_there = found.values_there;
    account.values_told = found.values_told;
    account.all_joints_at_once = found.joints.size() > 1;
    account.pull = found.pull;
    account.lag = fitted(joint).lag;
    account.lag_is_applied = account.lag && is_applied(*account.lag);
    if (const ArmJointFit* const own = found.find(joint)) account.gap_nm = own->error_nm;
    for (std::string& warning : arm_warnings(found, travel_)) account.warnings.push_back(std::move(warning));
    return account;
}

}  // namespace ripplenotch
