// SPDX-License-Identifier: MIT
// Which attribute of a joint of MuJoCo, or which element on it, an effect is.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view motor_words = R"(input="none" motorconst="1e-9" resistance="1")";

// For an attribute between double quotes.
std::string xml_words(std::string_view text) {
    std::string words;
    for (const char c : text) {
        if (c == '&')
            words += "&amp;";
        else if (c == '<')
            words += "&lt;";
        else if (c == '"')
            words += "&quot;";
        else
            words += c;
    }
    return words;
}

// A comment that lists what is held and what is not; `heading` first.
std::string mjcf_comment(const JointMjcf& mjcf, std::span<const std::string> heading) {
    std::vector<std::string> lines(heading.begin(), heading.end());
    for (const MjcfPart& part : mjcf.holds)
        lines.push_back(fmt::format("held: {}, as {}", part.effect, part.words));
    for (const MjcfPart& part : mjcf.not_held)
        lines.push_back(fmt::format("not held: {}: {}", part.effect, part.words));
    lines.emplace_back(
        "A torque sensor shows qfrc_inverse, plus the force of ripple_*, less that of friction_*.");
    return xml_comment(lines);
}

// "0.3 1e-05", or one number where there is no friction with the square of the speed.
std::string damping_words(const JointMjcf& mjcf) {
    std::string words = shortest(mjcf.damping);
    if (mjcf.quadratic_damping != 0.0) words += " " + shortest(mjcf.quadratic_damping);
    return words;
}

// The dcmotors, a line each, whose names end in `ending`. The compiler requires a motor constant and a
// resistance above 0.
std::string mjcf_motors(const JointMjcf& mjcf, std::string_view joint, std::string_view ending) {
    std::string text;
    const auto motor = [&](const std::string& name, const std::string& words) {
        text += fmt::format("    <dcmotor name=\"{}{}\" joint=\"{}\" {} {}/>\n", name, xml_words(ending),
                            xml_words(joint), motor_words, words);
    };
    for (const MjcfWave& wave : mjcf.waves)
        motor(wave.name, fmt::format("cogging=\"{} {} {}\"", shortest(wave.amplitude_nm),
                                     shortest(wave.poles), shortest(wave.phase_rad)));
    for (const MjcfBristle& bristle : mjcf.bristles)
        motor(bristle.name, fmt::format("lugre=\"{} 0 {} {} 1\"", shortest(bristle.stiffness_nm_rad),
                                        shortest(bristle.friction_nm), shortest(bristle.friction_nm)));
    return text;
}

// A joint as a file of MuJoCo's of its own.

constexpr double gravity_m_s2 = 9.81;
// MuJoCo needs some inertia: the value for a model that states none, and that of the body about its own
// centre.
constexpr double next_to_no_inertia_kgm2 = 1e-6, own_inertia_kgm2 = 1e-9;
// tanh(v / width) as a sum of parts, each share * clip(v / (wider * width), -1, 1): by squares over all
// speeds the nearest of two, 0.05 apart at most.
struct StepPart {
    double share, wider;
};
constexpr StepPart steep{0.5163, 0.8}, flat{0.4837, 1.95};
// The least impedance that MuJoCo accepts: the constraint is soft then, and its force depends on the speed
// alone.
constexpr double softest = 1e-4;
constexpr double longest_step_s = 0.002, shortest_step_s = 1e-5;

// A point mass with the weight in the model, and at most a quarter of its inertia.
struct PointMass {
    double mass_kg = 1.0, distance_m = 0.0;
    [[nodiscard]] double inertia_kgm2() const { return mass_kg * distance_m * distance_m; }
};

PointMass point_mass(const JointMjcf& mjcf, double inertia_kgm2) {
    const double first_moment = mjcf.weight_nm / gravity_m_s2;
    const double kg = std::max(1.0, 4.0 * first_moment * first_moment / inertia_kgm2);
    return {kg, first_moment / kg};
}

// The friction's force is -R^-1 (acceleration + B v), R = (1 - softest) / softest / inertia, held within
// frictionloss; direct values of solreffriction are multiples of B.
std::string friction_words(const JointMjcf& mjcf, const StepPart& part, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return "";
    const double nm = to_digits(part.share * mjcf.frictionloss_nm, 10);
    const double slope = nm / (part.wider * mjcf.friction_width_rad_s);
    const std::string soft = shortest(softest);
    return fmt::format(" frictionloss=\"{}\" solimpfriction=\"{} {} 0.001 0.5 2\" solreffriction=\"0 {}\"",
                       shortest(nm), soft, soft, shortest(-(1.0 - softest) * slope / inertia_kgm2));
}

// A joint has one frictionloss; a tendon round it alone has the other part.
std::string tendon_text(const JointMjcf& mjcf, std::string_view joint, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return "";
    return fmt::format(
        "  <tendon>\n    <fixed name=\"friction\"{}>\n      <joint joint=\"{}\" coef=\"1\"/>\n    </fixed>\n"
        "  </tendon>\n",
        friction_words(mjcf, flat, inertia_kgm2), xml_words(joint));
}

// A simulation forward in time needs a step below twice inertia over slope.
double time_step_s(const JointMjcf& mjcf, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return longest_step_s;
    const double steady = inertia_kgm2 * mjcf.friction_width_rad_s / mjcf.frictionloss_nm;
    return to_digits(std::clamp(steady, shortest_step_s, longest_step_s), 2);
}

}  // namespace

std::string write_mjcf(const JointMjcf& mjcf, std::string_view joint, std::span<const std::string> heading) {
    const double inertia = std::max(mjcf.inertia_kgm2, next_to_no_inertia_kgm2);
    const PointMass point = point_mass(mjcf, inertia);
    const double armature = inertia - point.inertia_kgm2() - own_inertia_kgm2;
    std::string words = fmt::format("armature=\"{}\"", shortest(armature));
    if (mjcf.damping != 0.0 || mjcf.quadratic_damping != 0.0)
        words += fmt::format(" damping=\"{}\"", damping_words(mjcf));
    words += friction_words(mjcf, steep, inertia);
    std::string text = mjcf_comment(mjcf, heading);
    text += fmt::format(
        "<mujoco>\n  <compiler angle=\"radian\"/>\n  <option timestep=\"{}\" gravity=\"0 0 -{}\"/>\n"
        "  <worldbody>\n    <body name=\"link\">\n"
        "      <inertial mass=\"{}\" pos=\"{} 0 {}\" diaginertia=\"{} {} {}\"/>\n"
        "      <joint name=\"{}\" type=\"hinge\" axis=\"0 -1 0\" {}/>\n    </body>\n  </worldbody>\n",
        shortest(time_step_s(mjcf, inertia)), shortest(gravity_m_s2), shortest(point.mass_kg),
        shortest(point.distance_m * portable::cos(mjcf.weight_rad)),
        shortest(point.distance_m * portable::sin(mjcf.weight_rad)), shortest(own_inertia_kgm2),
        shortest(own_inertia_kgm2), shortest(own_inertia_kgm2), xml_words(joint), words);
    text += tendon_text(mjcf, joint, inertia);
    const std::string motors = mjcf_motors(mjcf, joint, "");
    if (!motors.empty()) text += "  <actuator>\n" + motors + "  </actuator>\n";
    return text + "</mujoco>\n";
}

namespace {

struct MjcfReason {
    std::string_view effect, words;
};
constexpr std::array reasons = {
    MjcfReason{"offset",
               "the zero of a sensor is no torque on the joint; subtract it from the sensor's torque"},
    MjcfReason{"drift", "nothing there follows the time; subtract it from the sensor's torque"},
    MjcfReason{"tone", "nothing there follows the time"},
    MjcfReason{
        "stribeck-friction",
        "lugre has it only with a stiffness and a damping of its bristle, which no log here determines"},
    MjcfReason{"load-friction", "frictionloss does not follow the load"},
    MjcfReason{"payload-change", "a body has one mass at all times; attach the payload in the simulation"},
    MjcfReason{"asymmetric-friction", "frictionloss is the same in both directions"},
    MjcfReason{"asymmetric-viscous-friction", "damping is the same in both directions"},
    MjcfReason{"position-dependent-friction", "frictionloss does not follow the angle"},
    MjcfReason{"friction-warm-up", "frictionloss does not follow the time"},
    MjcfReason{"backlash", "play takes two bodies, motor and link, with a limit between them"},
    MjcfReason{"start-stop-ringing", "it is the answer of a controller, which the file has not"},
    MjcfReason{"velocity-bias", "it is an error of the log's speed"},
    MjcfReason{"encoder-eccentricity", "it is an error of the log's angle"},
};

std::string why_not(const Effect& effect) {
    for (const MjcfReason& reason : reasons)
        if (reason.effect == effect.name) return std::string(reason.words);
    switch (effect.side) {
        case Side::ripple:
            return "cogging has one size and phase at every speed, position and load";
        case Side::sensor:
            return "it is the torque sensor's, not the joint's";
        case Side::converter:
            return "it is a fault of the log";
        default:
            return "it has no place in a joint";
    }
}

double turn_rad(double degrees) {
    return (degrees - 360.0 * std::floor(degrees / 360.0)) / degrees_per_radian;
}

// amplitude cos(poles q + phase) as amplitude sin(poles q + phase + a quarter of a turn).
MjcfWave wave_of(std::string name, double amplitude_nm, double poles, double phase_deg) {
    return {std::move(name), amplitude_nm, poles, turn_rad(phase_deg + 90.0)};
}

// Two weights on one joint are one.
void add_weight(JointMjcf& mjcf, double nm, double phase_deg) {
    const double angle = phase_deg / degrees_per_radian;
    const double along = mjcf.weight_nm * portable::cos(mjcf.weight_rad) + nm * portable::cos(angle);
    const double up = mjcf.weight_nm * portable::sin(mjcf.weight_rad) + nm * portable::sin(angle);
    mjcf.weight_nm = portable::hypot(along, up);
    mjcf.weight_rad = portable::atan2(up, along);
}

// Orders of ripple that a resonance of their own changes: without it their size and phase are another's.
std::vector<double> ringing_orders(const Model& model) {
    std::vector<double> orders;
    for (const Term& term : model.terms) {
        if (side_of(term) != Side::ripple || term.effect->domain != Domain::frequency) continue;
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            if (term.effect->parameters[p].name == "order" && *term.values[p] > 0.0)
                orders.push_back(*term.values[p]);
        }
    }
    return orders;
}

class Taking {
  public:
    explicit Taking(const Model& model) : ratio_(ratio_of(model)), ringing_orders_(ringing_orders(model)) {
        mjcf_.held.gear_ratio = model.gear_ratio;
    }

    void take(const Term& term) {
        if (term.effect->ripple_order && rings(*term.values[*term.effect->ripple_order])) {
            mjcf_.not_held.push_back({std::string(term.effect->name),
                                      "it rings, and cogging has one size and phase at every speed"});
            return;
        }
        if (term.effect->resists && *term.values.front() < 0.0) {
            mjcf_.not_held.push_back(
                {std::string(term.effect->name),
                 "its size is below 0: subtract it from the friction of the simulation"});
            return;
        }
        std::string words = place_of(term.effect->name, values_of(term));
        std::string name(term.effect->name);
        if (words.empty()) {
            mjcf_.not_held.push_back({std::move(name), why_not(*term.effect)});
        } else if (words == second_step) {
            mjcf_.not_held.push_back({std::move(name), std::move(words)});
        } else {
            mjcf_.holds.push_back({std::move(name), std::move(words)});
            mjcf_.held.terms.push_back(term);
            begin_at_rest(mjcf_.held.terms.back());
        }
    }
    JointMjcf taken() { return std::move(mjcf_); }

  private:
    [[nodiscard]] bool rings(double order) const {
        return std::find(ringing_orders_.begin(), ringing_orders_.end(), order) != ringing_orders_.end();
    }

    static constexpr std::string_view second_step = "a joint has one frictionloss, and the model two steps";

    // Empty: none.
    std::string place_of(std::string_view name, const std::vector<double>& v) {
        if (name == "inertia") return mjcf_.inertia_kgm2 += v[0], "armature";
        if (name == "gravity") return add_weight(mjcf_, v[0], v[1]), "mass and position of the body";
        if (name == "coulomb-friction") return coulomb(v);
        if (name == "viscous-friction") return mjcf_.damping += v[0] * degrees_per_radian, "damping";
        if (name == "quadratic-viscous-friction") {
            mjcf_.quadratic_damping += v[0] * degrees_per_radian * degrees_per_radian;
            return "damping, its second number";
        }
        if (name == "ripple") return wave("ripple", v, ratio_.value());
        if (name == "output-ripple") return wave("ripple_output", v, 1.0);
        if (name == "hysteresis") return bristle(v);
        if (name == "gear-ratio") return "poles of the cogging";
        return {};
    }

    std::string coulomb(const std::vector<double>& v) {
        if (mjcf_.frictionloss_nm > 0.0) return std::string(second_step);
        mjcf_.frictionloss_nm = v[0];
        mjcf_.friction_width_rad_s = v[1] / degrees_per_radian;
        return "frictionloss";
    }

    std::string wave(std::string_view kind, const std::vector<double>& v, double ratio) {
        std::string name = fmt::format("{}_{}", kind, shortest(v[0]));
        for (const MjcfWave& known : mjcf_.waves)
            if (known.name == name) name += "_again";
        mjcf_.waves.push_back(wave_of(std::move(name), v[1], v[0] * ratio, v[2]));
        return "cogging of a dcmotor";
    }

    // MuJoCo 3.14 refuses a keyframe with states of some of several dcmotors.
    void begin_at_rest(Term& held) {
        if (held.effect->name != "hysteresis" || start_rad_ == 0.0) return;
        held.values[2] = 0.0;
        mjcf_.not_held.push_back(
            {"hysteresis", fmt::format("its bristle begins at 0; set act of {} to {} rad first",
                                       mjcf_.bristles.back().name, shortest(to_digits(start_rad_)))});
    }

    // Dahl: the bristle slips at torque_nm and is worn by 63 % after width_deg.
    std::string bristle(const std::vector<double>& v) {
        start_rad_ = 0.0;
        if (v[0] == 0.0) return "nothing, of 0 Nm";
        const double width_rad = v[1] / degrees_per_radian;
        start_rad_ = v[2] * width_rad;
        mjcf_.bristles.push_back(
            {fmt::format("friction_{}", mjcf_.bristles.size() + 1), v[0] / width_rad, v[0]});
        return "lugre of a dcmotor";
    }

    JointMjcf mjcf_;
    GearRatio ratio_;
    std::vector<double> ringing_orders_;
    double start_rad_ = 0.0;  // start angle of the last bristle
};

}  // namespace

GearRatio ratio_of(const Model& model) {
    GearRatio ratio = model.gear_ratio;
    Motion none;
    for (const Term& term : model.terms)
        if (term.effect->name == "gear-ratio") term.effect->change_motion(values_of(term), none, ratio);
    return ratio;
}

JointMjcf joint_mjcf(const Model& model) {
    Taking taking(model);
    for (const Term& term : model.terms) taking.take(term);
    return taking.taken();
}

// Writes a joint's friction and motors into an existing MuJoCo file, whose text otherwise stays as it is.

namespace {

// MuJoCo's step turns over where the speed is the acceleration times half of this time (s): five times sooner
// than by default, and still slower than two steps of 2 ms, which MuJoCo requires.
constexpr std::string_view quick_step = "0.004 1";

struct XmlAttribute {
    std::string_view name, value;
    std::size_t from = 0, to = 0;  ///< range of the value in the file
};

// One start tag of a file; the reader of chains has read the file, so that it is sound.
struct XmlTag {
    std::string_view name;
    std::size_t from = 0, name_end = 0, end = 0;  ///< at '<', behind the name, behind '>'
    std::vector<XmlAttribute> attributes;

    [[nodiscard]] const XmlAttribute* find(std::string_view wanted) const {
        for (const XmlAttribute& one : attributes)
            if (one.name == wanted) return &one;
        return nullptr;
    }
};

XmlTag tag_at(std::string_view text, std::size_t at) {
    XmlTag tag;
    tag.from = at;
    const std::size_t name = at + 1;
    tag.name_end = std::min(text.find_first_of(" \t\r\n/>", name), text.size());
    tag.name = text.substr(name, tag.name_end - name);
    std::size_t place = tag.name_end;
    while (place < text.size() && text[place] != '>') {
        const std::size_t quote = text.find_first_of("\"'>", place);
        if (quote == std::string_view::npos || text[quote] == '>') {
            place = std::min(quote, text.size());
            break;
        }
        const std::size_t close = std::min(text.find(text[quote], quote + 1), text.size());
        const std::size_t equals = std::min(text.rfind('=', quote), quote);
        const std::size_t last = text.find_last_not_of(" \t\r\n", equals == 0 ? 0 : equals - 1);
        const std::size_t first = text.find_last_of(" \t\r\n", last) + 1;
        tag.attributes.push_back({text.substr(first, last + 1 - first),
                                  text.substr(quote + 1, close - quote - 1), quote + 1, close});
        place = close + 1;
    }
    tag.end = std::min(place + 1, text.size());
    return tag;
}

// The first tag that matches, ignoring comments.
template <class IsIt>
std::optional<XmlTag> first_tag(std::string_view text, const IsIt& is_it) {
    for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
        if (text.substr(at, 4) == "<!--") {
            at = std::min(text.find("-->", at), text.size() - 1);
            continue;
        }
        XmlTag tag = tag_at(text, at);
        at = tag.end;
        if (is_it(tag)) return tag;
    }
    return std::nullopt;
}

// The joint of this name within the worldbody.
std::optional<XmlTag> joint_tag(std::string_view text, std::string_view joint) {
    bool within = false;
    const std::string written = xml_words(joint);
    return first_tag(text, [&](const XmlTag& tag) {
        if (tag.name == "worldbody") within = true;
        if (tag.name == "/worldbody") within = false;
        const XmlAttribute* const name = tag.find("name");
        return within && tag.name == "joint" && name != nullptr &&
               (name->value == joint || name->value == written);
    });
}

// The tag's attributes with these values; those that are not there yet follow the tag's name.
std::string joint_with_values(std::string_view text, const XmlTag& tag,
                              std::span<const std::pair<std::string_view, std::string>> values) {
    std::string changed(text);
    std::vector<std::pair<XmlAttribute, std::string>> there;
    std::string added;
    for (const auto& [name, value] : values) {
        if (const XmlAttribute* const known = tag.find(name))
            there.emplace_back(*known, value);
        else
            added += fmt::format(" {}=\"{}\"", name, value);
    }
    // From behind, so that places hold.
    std::sort(there.begin(), there.end(),
              [](const auto& a, const auto& b) { return a.first.from > b.first.from; });
    for (const auto& [known, value] : there) changed.replace(known.from, known.to - known.from, value);
    return changed.insert(tag.name_end, added);
}

// Names of motors that the file has not yet.
std::string free_ending(const JointMjcf& mjcf, std::string_view text, std::string_view joint) {
    std::string ending = fmt::format("_{}", joint);
    const auto taken = [&] {
        const std::string tail = xml_words(ending) + "\"";
        for (const MjcfWave& wave : mjcf.waves)
            if (text.find("\"" + wave.name + tail) != std::string_view::npos) return true;
        for (const MjcfBristle& one : mjcf.bristles)
            if (text.find("\"" + one.name + tail) != std::string_view::npos) return true;
        return false;
    };
    while (taken()) ending += "_again";
    return ending;
}

}  // namespace

std::string write_into_mjcf(const JointMjcf& mjcf, std::string_view text, const std::string& source,
                            std::string_view joint, std::span<const std::string> heading) {
    const auto tag = joint_tag(text, joint);
    const std::size_t end = text.rfind("</mujoco");
    if (!tag || end == std::string_view::npos)
        raise<UsageError>(
            "{}: there is no joint with name=\"{}\" in its worldbody to be written into; give the joint its "
            "name, or write the improved model as .json",
            source, joint);
    std::string changed(text);
    const std::string motors = mjcf_motors(mjcf, joint, free_ending(mjcf, text, joint));
    if (!motors.empty()) changed.insert(end, "  <actuator>\n" + motors + "  </actuator>\n");
    const std::pair<std::string_view, std::string> values[] = {
        {"damping", damping_words(mjcf)},
        {"frictionloss", shortest(mjcf.frictionloss_nm)},
        {"solreffriction", std::string(quick_step)}};
    changed = joint_with_values(changed, *tag, values);
    // Before the root, behind a declaration, which has to be first.
    const auto root = first_tag(changed, [](const XmlTag& one) { return one.name == "mujoco"; });
    return changed.insert(root ? root->from : 0, mjcf_comment(mjcf, heading));
}

}  // namespace ripplenotch
