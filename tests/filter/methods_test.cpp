// SPDX-License-Identifier: MIT
// What every method promises, and methods against SciPy. Settings are made up from the method's own list of
// keys, so that a new entry of methods.def is tested the day it is listed; the vectors of SciPy are
// made by scripts/make-filter-reference.

#include <array>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "filter/tables.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

constexpr double constant_nm = -0.512;

std::string some_number(const Key& key, std::mt19937& engine) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(std::max({low, key.above, key.at_least}),
                                                      std::min(high, key.at_most))(engine);
    };
    // Told of another torque at rest, the oscillator would rightly call the constant ripple.
    if (key.name == "rest") return fmt::format("{}Nm", constant_nm);
    // Without it the oscillator is linear, and its frozen filter exact.
    if (key.name == "slip") return "0";
    // Nothing is too fast for the maps of the laws.
    if (key.name == "fastest") return "1e6deg/s";
    if (key.name == "gear-ratio") return fmt::format("{:.3f}", between(60.0, 140.0));
    switch (key.dimension) {
        case Dimension::frequency:
            return fmt::format("{:.3f}Hz", between(2.0, 120.0));
        case Dimension::time:
            return fmt::format("{:.4f}s", between(0.0, 0.2));
        case Dimension::speed:
            return fmt::format("{:.3f}deg/s", between(0.0, 5.0));
        case Dimension::decibel:
            return fmt::format("{:.2f}dB", between(3.0, 60.0));
        case Dimension::torque:
            return fmt::format("{:.3f}Nm", between(0.02, 2.0));
        case Dimension::angle:
            return fmt::format("{:.2f}deg", between(-180.0, 180.0));
        default:
            return key.default_text.empty() ? fmt::format("{:.3f}", between(0.2, 4.0))
                                            : std::string(key.default_text);
    }
}

// Two orders: by the motor where a gear ratio is given beside them, else by the joint.
std::string some_orders(bool by_motor, std::mt19937& engine) {
    std::uniform_real_distribution<double> order(1.0, 4.0);
    const double first = order(engine), second = order(engine);
    return by_motor ? fmt::format("{:.3f}:{:.3f}", first, second)
                    : fmt::format("{:.1f}/turn:{:.1f}/turn", 100.0 * first, 100.0 * second);
}

std::string some_pair(const Key& key, std::mt19937& engine) {
    // A map has a value for each speed and order; the other lists have one for each order.
    if (key.name == "speeds") return some_number(key, engine);
    return some_number(key, engine) + ":" + some_number(key, engine);
}

// Specifications of a method: its defaults, every choice of every key, random numbers, and every list that
// may be left out.
std::set<std::string> specifications(const Method& method, unsigned seed) {
    std::mt19937 engine(seed);
    std::vector<std::vector<std::string>> variants;
    const auto build = [&](const Key* varied, std::string_view value, bool all_numbers, bool lists = false) {
        Spec spec{std::string(method.name), {}};
        for (const Key& key : method.keys) {
            const std::string name(key.name);
            if (varied == &key)
                spec.values.emplace_back(name, value);
            else if (name == "orders")
                spec.values.emplace_back(name, some_orders(all_numbers, engine));
            else if (key.kind == KeyKind::text)
                spec.values.emplace_back(name, "table.json");
            else if (key.kind == KeyKind::list && (key.required || lists))
                spec.values.emplace_back(name, some_pair(key, engine));
            else if (key.kind == KeyKind::number && key.choices.empty() && (key.required || all_numbers))
                spec.values.emplace_back(name, some_number(key, engine));
        }
        return spec.text();
    };
    std::set<std::string> texts = {build(nullptr, {}, false), build(nullptr, {}, true),
                                   build(nullptr, {}, false, true), build(nullptr, {}, true, true)};
    for (const Key& key : method.keys) {
        for (const auto choice : split(key.choices, ' ')) {
            if (choice.empty()) continue;
            texts.insert(build(&key, choice, false));
            texts.insert(build(&key, choice, true));
        }
    }
    return texts;
}

// A filter that is told of a ripple takes it out of a constant as well, as it should.
bool knows_ripple(const std::string& text) {
    return text.find("phases=") != std::string::npos || text.find("cosines=") != std::string::npos;
}

// The same samples in pieces of up to 400.
std::vector<double> in_pieces(CausalFilter& filter, const Signals& s) {
    std::mt19937 engine(11);
    std::vector<double> out(s.torque_nm.size());
    for (std::size_t at = 0; at < out.size();) {
        const std::size_t count = std::min<std::size_t>(
            std::uniform_int_distribution<std::size_t>(0, 400)(engine), out.size() - at);
        filter.process(s.part(at, count), std::span(out).subspan(at, count));
        at += count;
    }
    return out;
}

template <class Check>
void for_all_methods(Check check) {
    const CandidateTable table = paper_table();
    for (const Method* method : methods()) {
        for (unsigned seed : {1U, 2U}) {
            for (const std::string& text : specifications(*method, seed)) {
                INFO(text);
                check(text, table);
            }
        }
    }
}

// The columns of the file by name.
std::map<std::string, std::vector<double>> reference() {
    std::ifstream file(source_folder() + "/tests/filter/data/scipy.csv");
    std::map<std::string, std::vector<double>> columns;
    std::vector<std::string> names;
    std::string line, cell;
    std::getline(file, line);
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        for (const std::string& name : names) {
            std::getline(cells, cell, ',');
            const auto value = parse_number(cell);
            REQUIRE(value);
            columns[name].push_back(*value);
        }
    }
    REQUIRE(columns["torque_nm"].size() == 300);
    return columns;
}

void check(const std::string& name, const std::string& spec) {
    auto columns = reference();
    const CandidateTable table = paper_table();
    const auto out = filtered(*start(spec, &table), {columns["velocity_deg_s"], columns["torque_nm"], {}});
    REQUIRE(columns[name].size() == out.size());
    double worst = 0.0;
    for (std::size_t k = 0; k < out.size(); ++k) worst = std::max(worst, std::abs(out[k] - columns[name][k]));
    INFO(name);
    CHECK(worst < 1e-9);
}

}  // namespace

TEST_CASE("the settings that a method holds worth trying start, and each states its multiplications") {
    const GearAccount gear{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, "test"};
    const auto tried = [&](const Method& method, double fastest_deg_s) {
        return method.trials({gear, Hertz(1000.0), Hertz(1000.0), DegPerSec(10.0), DegPerSec(60.0),
                              DegPerSec(fastest_deg_s), ""});
    };
    std::map<std::string_view, double> multiplications;
    for (const Method* method : methods()) {
        INFO(method->name);
        CHECK((method->multiplications == nullptr) == (method->part == MethodPart::control));
        CHECK((method->trials == nullptr) == (method->part == MethodPart::control));
        if (method->trials == nullptr) continue;
        for (const Trial& trial : tried(*method, 60.0).all) {
            std::string text = std::string(method->name) + trial.settings;
            const bool follows = std::any_of(method->keys.begin(), method->keys.end(),
                                             [](const Key& key) { return key.name == "gear-ratio"; });
            if (follows) text += ",gear-ratio=100,orders=1:2";
            std::optional<CandidateTable> table;
            if (trial.table) table = CandidateTable::design(*trial.table);
            const Settings settings("method", parse_spec(text), method->keys);
            CHECK(method->start(settings, Hertz(1000.0), table ? &*table : nullptr) != nullptr);
            multiplications.emplace(method->name,
                                    method->multiplications(settings, table ? &*table : nullptr));
        }
    }
    // One section; two in the paper's form; two in the state-variable form; two that are retuned; six states.
    CHECK(multiplications["lowpass"] == 5.0);
    CHECK(multiplications["fixed"] == 10.0);
    CHECK(multiplications["switching"] == 22.0);
    CHECK(multiplications["tracking"] == 1.0 + 2.0 * (13.0 + 6.0 + 9.0 + 22.0));
    CHECK(multiplications["oscillator"] == 1.5 * 36.0 + 5.5 * 6.0 + 2.0 * 36.0 + 23.0);
    CHECK(tried(find_method("fixed"), 90.0).none_because != "");
    CHECK(tried(find_method("map"), 60.0).all.empty());
}

TEST_CASE("the same lines give the same filter, whatever gear ratio names them, or none") {
    const Signals signals = wandering(20000, 5);
    const std::array<std::string, 3> lines = {"orders=200/turn:400/turn", "gear-ratio=100,orders=2:4",
                                              "gear-ratio=200,orders=1:2"};
    const std::array<std::string, 5> methods = {"tracking", "tracking,max-delay=2ms,composite=double",
                                                "oscillator", "oscillator,gain=scheduled",
                                                "oscillator,amplitudes=0.8:0.4,phases=10:20"};
    const std::string map = ",cosines=0.3Nm:0.2Nm,sines=0.1Nm:-0.1Nm,spread=0.05Nm:0.05Nm";
    const auto agree = [&](const std::string& method, const std::string& more) {
        INFO(method);
        const auto first = filtered(*start(method + "," + lines[0] + more), signals.samples());
        for (const std::string& other : {lines[1], lines[2], lines[0] + ",gear-ratio=100"})
            CHECK(first == filtered(*start(method + "," + other + more), signals.samples()));
    };
    for (const std::string& method : methods) agree(method, "");
    agree("map", map);
    agree("oscillator", map);
    agree("oscillator,zero=unknown", map);
    const auto by_table = [&](GearRatio ratio, std::vector<Order> orders) {
        TableSpec spec = table_spec(std::move(orders));
        spec.gear_ratio = ratio;
        spec.bands = bands_by_spacing({DegPerSec(18.0), DegPerSec(180.0)}, DegPerSec(18.0));
        const CandidateTable table = CandidateTable::design(spec);
        return filtered(*start("switching,table=table.json", &table), signals.samples());
    };
    CHECK(by_table(no_ratio, {Order(200.0), Order(400.0)}) ==
          by_table(GearRatio(100.0), {Order(2.0), Order(4.0)}));
}

TEST_CASE("methods have a name, a summary, and keys with help, each name once") {
    std::set<std::string_view> names;
    for (const Method* method : methods()) {
        INFO(method->name);
        CHECK(names.insert(method->name).second);
        CHECK_FALSE(method->summary.empty());
        CHECK(method->start != nullptr);
        CHECK(method->frozen != nullptr);
        CHECK(&find_method(method->name) == method);
        std::set<std::string_view> keys;
        for (const Key& key : method->keys) {
            CHECK(keys.insert(key.name).second);
            CHECK_FALSE(key.help.empty());
        }
        CHECK(method->needs_table == (keys.count("table") == 1));
    }
    CHECK_THROWS_WITH(find_method("lowpas"), Catch::Contains("did you mean lowpass?"));
}

TEST_CASE("one method is the control, and what is exported as coefficients runs as these at any speed") {
    std::size_t controls = 0;
    for (const Method* method : methods()) controls += method->part == MethodPart::control ? 1 : 0;
    CHECK(controls == 1);
    for_all_methods([](const std::string& text, const CandidateTable&) {
        const Spec spec = parse_spec(text);
        const Method& method = find_method(spec.name);
        if (method.steady == nullptr) return;
        const Settings settings("method", spec, method.keys);
        const SteadyDesign design = method.steady(settings);
        Cascade designed;
        if (const auto* notches = std::get_if<std::vector<NotchSpec>>(&design)) {
            for (const NotchSpec& notch : *notches) designed.push_back(design_notch(notch, Hertz(1000.0)));
        } else {
            designed = design_low_pass(std::get<LowPassSpec>(design), Hertz(1000.0));
        }
        for (const double speed : {0.0, 90.0})
            CHECK(method.frozen(settings, Hertz(1000.0), nullptr, DegPerSec(speed)).cascade == designed);
    });
}

TEST_CASE("a constant torque passes every method bit for bit from the first sample, at any speed") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        if (knows_ripple(text)) return;
        Signals s = wandering(4000, 5);
        s.torque_nm.assign(4000, constant_nm);
        const auto filter = start(text, &table);
        CHECK(same_bits(filtered(*filter, s.samples()), s.torque_nm));
    });
}

TEST_CASE("any split into blocks gives every method's same bytes") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        const Signals s = wandering(6000, 7);
        const auto whole = start(text, &table);
        const auto expected = filtered(*whole, s.samples());
        const auto pieces = start(text, &table);
        CHECK(same_bits(in_pieces(*pieces, s), expected));
        REQUIRE(pieces->switch_count() == whole->switch_count());
        REQUIRE(pieces->switches().size() == whole->switches().size());
        for (std::size_t i = 0; i < whole->switches().size(); ++i) {
            CHECK(pieces->switches()[i].sample == whole->switches()[i].sample);
            CHECK(pieces->switches()[i].jump_nm == whole->switches()[i].jump_nm);
        }
    });
}

TEST_CASE("every method is causal: later samples do not change earlier outputs") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        const Signals s = wandering(3000, 13);
        Signals other = wandering(3000, 14);
        for (auto member : {&Signals::velocity_deg_s, &Signals::torque_nm, &Signals::position_deg}) {
            std::copy_n((s.*member).begin(), 1500, (other.*member).begin());
        }
        auto a = filtered(*start(text, &table), s.samples());
        auto b = filtered(*start(text, &table), other.samples());
        a.resize(1500);
        b.resize(1500);
        CHECK(same_bits(a, b));
    });
}

TEST_CASE("after a restart every method gives what a new filter gives") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        const Signals s = wandering(4000, 17);
        const auto filter = start(text, &table);
        filtered(*filter, s.part(0, 2500));
        filter->restart();
        CHECK(same_bits(filtered(*filter, s.part(2500, 1500)),
                        filtered(*start(text, &table), s.part(2500, 1500))));
    });
}

TEST_CASE("every method's frozen filter is stable and passes 0 Hz with gain 1") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        const Spec spec = parse_spec(text);
        const Method& method = find_method(spec.name);
        const Settings settings("method", spec, method.keys);
        for (double speed = -200.0; speed <= 300.0; speed += 12.5) {
            const FrozenFilter frozen = method.frozen(settings, Hertz(1000.0), &table, DegPerSec(speed));
            CHECK(pole_radius(frozen.cascade) < 1.0);
            CHECK(std::abs(response(frozen.cascade, Hertz(0.0), SampledAt(Hertz(1000.0)))) ==
                  Approx(1.0).margin(1e-9));
            CHECK_FALSE(frozen.note.empty());
        }
    });
}

TEST_CASE("at one speed every method does what its frozen filter says, once settled") {
    for_all_methods([](const std::string& text, const CandidateTable& table) {
        const Spec spec = parse_spec(text);
        const Method& method = find_method(spec.name);
        const double speed = 99.0, hz = 31.0;
        const FrozenFilter frozen =
            method.frozen(Settings("method", spec, method.keys), Hertz(1000.0), &table, DegPerSec(speed));
        if (frozen.follows_ripple) return;
        const auto gain = response(frozen.cascade, Hertz(hz), SampledAt(Hertz(1000.0)));
        const auto filter = start(text, &table);
        // Narrow filters take their time: a second more and more, until what is left is rounding.
        double worst = 1.0;
        for (std::size_t first = 0; worst >= 1e-8 && first < 640000; first += 4000) {
            Signals s;
            for (std::size_t k = first; k < first + 4000; ++k) {
                s.velocity_deg_s.push_back(speed);
                s.position_deg.push_back(speed * static_cast<double>(k) / 1000.0);
                s.torque_nm.push_back(
                    std::cos(2.0 * std::numbers::pi * hz * static_cast<double>(k) / 1000.0));
            }
            const auto out = filtered(*filter, s.samples());
            worst = 0.0;
            for (std::size_t k = 2000; k < 4000; ++k) {
                const double phase = 2.0 * std::numbers::pi * hz * static_cast<double>(first + k) / 1000.0;
                worst = std::max(worst, std::abs(out[k] - (gain * std::polar(1.0, phase)).real()));
            }
        }
        CHECK(worst < 1e-8);
    });
}

TEST_CASE("notches agree with SciPy to 1e-9 Nm at every sample") {
    check("fixed_25_50_q025", "fixed,centers=25Hz:50Hz,q=0.25");
    check("fixed_20_40_80_q2", "fixed,centers=20Hz:40Hz:80Hz,q=2");
}

TEST_CASE("low-passes of order 1, 2, 4 and 10 agree with SciPy to 1e-9 Nm at every sample") {
    check("lowpass_13rad_s_order1", "lowpass,cutoff=13rad/s");
    check("lowpass_13hz_order2", "lowpass,cutoff=13Hz,order=2");
    check("lowpass_13hz_order4", "lowpass,cutoff=13Hz,order=4");
    check("lowpass_13hz_order10", "lowpass,cutoff=13Hz,order=10");
}

TEST_CASE("the switching filter with Table 1 agrees with SciPy to 1e-9 Nm at every sample") {
    check("switching_table1_parallel", "switching,table=t,transition=parallel");
}
