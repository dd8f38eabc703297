// SPDX-License-Identifier: MIT
// ripplenotch design: the table of candidate notch filters.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "cli/command.hpp"
#include "cli/joint_facts.hpp"
#include "cli/plot_request.hpp"
#include "cli/speed_bands.hpp"
#include "cli/table_text.hpp"
#include "ripplenotch/artifact/table.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/report/table_figure.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> width_names = {"analog", "digital"};
constexpr std::array<std::string_view, 3> rule_names = {"pass", "hold", "fade"};
constexpr std::array<std::string_view, 3> form_names = {"text", "csv", "json"};

struct Request {
    CommonOptions common;
    PlotRequest plot;
    std::string joint;
    std::optional<double> gear_ratio, depth_db, max_delay_ms, min_attenuation_db;
    std::vector<double> orders;
    std::optional<Hertz> sample_rate, spacing;
    std::optional<std::string> speed, bands;
    double q = 0.25, settle_band_percent = 0.5;
    std::string width = "analog", below = "pass", above = "hold", form;
};

OutsideRule rule_of(const std::string& name) {
    if (name == "hold") return OutsideRule::hold;
    return name == "fade" ? OutsideRule::fade : OutsideRule::pass;
}

// --spacing is that of the lowest order's centres, which is how the paper states its table: 5 Hz is 18 deg/s
// at 1:100.
DegPerSec width_of_spacing(Hertz spacing, const TableSpec& spec) {
    if (!(spacing.value() > 0.0))
        raise<UsageError>("--spacing {} Hz is not above 0", shortest(spacing.value()));
    return DegPerSec(360.0 * spacing.value() / (spec.orders.front().value() * spec.gear_ratio.value()));
}

// Nobody wants bands of 17.9993 deg/s because the gear ratio is known to five digits.
DegPerSec two_digits(DegPerSec width) {
    return DegPerSec(*parse_number(fmt::format("{:.1e}", width.value())));
}

// Bands about 5 Hz apart in the lowest order, as the paper's, over the speeds at which the lines were seen.
std::vector<std::pair<DegPerSec, DegPerSec>> bands_seen(const Request& request, const TableSpec& spec,
                                                        const JointFacts& joint) {
    if (!(joint.fastest.value() > 0.0)) {
        raise<UsageError>("{} has no line that follows the speed; give --speed FROM:TO:WIDTH", joint.source);
    }
    const double width = request.spacing ? width_of_spacing(*request.spacing, spec).value()
                                         : two_digits(width_of_spacing(Hertz(5.0), spec)).value();
    double from = std::floor(joint.slowest.value());
    double to = joint.fastest.value();
    // A joint seen at one speed only gets one band around it.
    if (to - from < width) from = std::max(0.0, 0.5 * (from + to) - 0.5 * width);
    const double limit_deg_s =
        180.0 * spec.sample_rate.value() / (spec.orders.back().value() * spec.gear_ratio.value());
    const double wanted = std::max(1.0, std::ceil((to - from) / width - 1e-9));
    double count = wanted;
    while (count > 0.0 && from + (count - 0.5) * width >= limit_deg_s) count -= 1.0;
    if (count < 1.0) {
        raise<UsageError>(
            "{}: order {} is not below half the sample rate, {} Hz, at {:.6g} deg/s, the slowest speed "
            "seen; choose lower --orders or --speed",
            joint.source, shortest(spec.orders.back().value()), shortest(0.5 * spec.sample_rate.value()),
            from + 0.5 * width);
    }
    if (count < wanted) {
        say_warnings(
            request.common,
            std::vector{fmt::format(
                "{}: lines were seen up to {:.6g} deg/s, but from {:.6g} deg/s on order {} "
                "is not below half the sample rate; the bands end at {:.6g} deg/s",
                joint.source, to, limit_deg_s, shortest(spec.orders.back().value()), from + count * width)});
    }
    to = from + count * width;
    return bands_by_spacing(DegPerSec(from), DegPerSec(to), DegPerSec(width));
}

std::vector<std::pair<DegPerSec, DegPerSec>> bands_of(const Request& request, const TableSpec& spec,
                                                      const std::optional<JointFacts>& joint) {
    if (request.bands) {
        if (request.speed || request.spacing) {
            raise<UsageError>("--bands lists the bands; it cannot be combined with --speed or --spacing");
        }
        return parse_speed_bands(*request.bands, "--bands");
    }
    if (!request.speed) {
        if (joint) return bands_seen(request, spec, *joint);
        raise<UsageError>(
            "no speeds to design for; give --speed FROM:TO:WIDTH (18:180:18) or --bands FROM:TO,FROM:TO");
    }
    const SpeedRange range = parse_speed_range(*request.speed, "--speed");
    if (range.width && request.spacing) {
        raise<UsageError>(
            "--speed {} already says how wide a band is; leave out its third number or --spacing",
            *request.speed);
    }
    if (!range.width && !request.spacing) {
        raise<UsageError>(
            "--speed {} does not say how wide a band is; write FROM:TO:WIDTH or add --spacing 5Hz",
            *request.speed);
    }
    return bands_by_spacing(range.from, range.to,
                            range.width ? *range.width : width_of_spacing(*request.spacing, spec));
}

std::optional<GearRatio> asked_ratio(const std::optional<double>& value) {
    return value ? std::optional(GearRatio(*value)) : std::nullopt;
}

// Options first, then joint.json, else the option that is missing.
void fill_joint(TableSpec& spec, const Request& request, const std::optional<JointFacts>& joint) {
    if (!request.gear_ratio && !joint) {
        raise<UsageError>("the gear ratio is missing; give --gear-ratio, for example 100");
    }
    spec.gear_ratio = request.gear_ratio ? GearRatio(*request.gear_ratio) : gear_ratio_of(*joint);
    if (!request.sample_rate && !joint) {
        raise<UsageError>("the sample rate is missing; give --sample-rate, for example 1kHz");
    }
    spec.sample_rate = request.sample_rate ? *request.sample_rate : joint->sample_rate;
    for (const double order : request.orders) spec.orders.emplace_back(order);
    std::sort(spec.orders.begin(), spec.orders.end());
    if (spec.orders.empty() && joint) spec.orders = joint->orders;
    if (spec.orders.empty()) {
        raise<UsageError>("no orders to notch{}; give --orders, for example 1,2",
                          joint ? fmt::format(": {} has no line that follows the speed", joint->source) : "");
    }
    // Otherwise --spacing would divide by it before the table is checked.
    if (!(spec.gear_ratio.value() > 0.0)) {
        raise<UsageError>("gear ratio {} is not above 0", shortest(spec.gear_ratio.value()));
    }
    if (!(spec.orders.front().value() > 0.0)) {
        raise<UsageError>("order {} is not above 0", shortest(spec.orders.front().value()));
    }
}

TableSpec spec_of(const Request& request, const std::optional<JointFacts>& joint) {
    TableSpec spec;
    fill_joint(spec, request, joint);
    spec.q = request.q;
    if (request.depth_db) spec.depth_db = *request.depth_db;
    spec.width = request.width == "digital" ? WidthRule::digital : WidthRule::analog;
    spec.settle_band_percent = request.settle_band_percent;
    spec.below = rule_of(request.below);
    spec.above = rule_of(request.above);
    spec.bands = bands_of(request, spec, joint);
    return spec;
}

// The options that would give this table without a joint.json and without arithmetic.
std::string option_line(const TableSpec& spec) {
    std::string orders, bands;
    for (const Order order : spec.orders) orders += (orders.empty() ? "" : ",") + shortest(order.value());
    for (const auto& [from, to] : spec.bands) {
        bands +=
            fmt::format("{}{}:{}", bands.empty() ? "" : ",", shortest(from.value()), shortest(to.value()));
    }
    return fmt::format("--gear-ratio {} --orders {} --sample-rate {}Hz --bands {}",
                       shortest(spec.gear_ratio.value()), orders, shortest(spec.sample_rate.value()), bands);
}

// Asked for by name, else by --json, else by the name of the output file.
std::string form_of(const Request& request) {
    if (request.common.json) {
        if (!request.form.empty() && request.form != "json") {
            raise<UsageError>("--json and --format {} ask for two different outputs", request.form);
        }
        return "json";
    }
    if (!request.form.empty()) return request.form;
    const std::string& path = request.common.output;
    const auto ends_with = [&path](std::string_view end) {
        return path.size() > end.size() && path.compare(path.size() - end.size(), end.size(), end) == 0;
    };
    return ends_with(".json") ? "json" : ends_with(".csv") ? "csv" : "text";
}

// Limits that the caller set: what breaks them is said, and the table is written all the same.
std::vector<std::string> violations(const Request& request, const CandidateTable& table) {
    std::vector<std::string> sentences;
    for (const Band& band : table.bands()) {
        const std::string label =
            fmt::format("band {} ({:.6g}-{:.6g} deg/s)", band.number, band.from.value(), band.to.value());
        const double delay_ms = 1e3 * band.dc_delay.value();
        if (request.max_delay_ms && !(delay_ms <= *request.max_delay_ms)) {
            sentences.push_back(fmt::format("{} delays by {:.1f} ms, more than --max-delay-ms {}", label,
                                            delay_ms, shortest(*request.max_delay_ms)));
        }
        for (std::size_t i = 0; request.min_attenuation_db && i < band.notches.size(); ++i) {
            const double worst_db = band.worst_attenuation_db[i];
            if (worst_db >= *request.min_attenuation_db) continue;
            sentences.push_back(
                fmt::format("{} takes as little as {:.1f} dB off order {}, less than "
                            "--min-attenuation-db {}",
                            label, worst_db, shortest(band.notches[i].order.value()),
                            shortest(*request.min_attenuation_db)));
        }
    }
    return sentences;
}

ExitCode run(const Request& request, const std::string& command_line) {
    const std::string form = form_of(request);
    check_plot(request.plot, request.common);
    std::optional<JointFacts> joint;
    Provenance provenance{{}, command_line};
    if (!request.joint.empty()) {
        joint = load_joint_facts(request.joint, asked_ratio(request.gear_ratio));
        provenance.inputs.push_back(input_record(request.joint));
    }
    const CandidateTable table = CandidateTable::design(spec_of(request, joint));
    say(request.common, fmt::format("designed as if with {}", option_line(table.spec())));
    say_warnings(request.common, alias_warnings(table));
    const std::string text = form == "json"  ? table_to_json(table, provenance)
                             : form == "csv" ? table_to_csv(table)
                                             : table_to_text(table);
    write_all(request.common.output, text, request.common.overwrite());
    draw_plot(request.plot, request.common, provenance, [&] { return table_figure(table); });
    const auto broken = violations(request, table);
    say_warnings(request.common, broken);
    return broken.empty() ? ExitCode::done : ExitCode::limit_violated;
}

std::function<ExitCode()> attach(Options& options) {
    auto request = std::make_shared<Request>();
    options.argument("JOINT", request->joint, false, "joint.json from identify; - is standard input");
    options.number("--gear-ratio", request->gear_ratio, Dimension::none, "motor turns per output turn");
    options.numbers("--orders", request->orders, Dimension::none,
                    "ripple lines to notch, in cycles per motor turn, e.g. 1,2");
    options.quantity("--sample-rate", request->sample_rate, Dimension::frequency,
                     "rate at which the filter will run");
    options.text("--speed", request->speed, "FROM:TO[:WIDTH]",
                 "bands of equal width in deg/s, e.g. 18:180:18");
    options.quantity("--spacing", request->spacing, Dimension::frequency,
                     "instead of WIDTH: distance of the lowest order's centres");
    options.text("--bands", request->bands, "FROM:TO,...",
                 "bands one by one in deg/s, e.g. 18:36,36:60,60:100");
    options.number("--q", request->q, Dimension::none, "centre over -3 dB width; 0.25 is the paper's twin-T");
    options.number("--depth", request->depth_db, Dimension::decibel,
                   "attenuation at the centre; a full null when left out");
    options.choice("--width", request->width, width_names,
                   "whose width Q is: the analogue prototype's or the sampled "
                   "filter's");
    options.number("--settle-band", request->settle_band_percent, Dimension::none,
                   "per cent of a step within which it counts as settled");
    options.choice("--below", request->below, rule_names, "rule below the first band");
    options.choice("--above", request->above, rule_names, "rule above the last band");
    options.number("--max-delay-ms", request->max_delay_ms, Dimension::none,
                   "exit code 1 when a band's DC delay is longer");
    options.number("--min-attenuation-db", request->min_attenuation_db, Dimension::none,
                   "exit code 1 when a line is attenuated less anywhere in its band");
    options.choice("--format", request->form, form_names,
                   "form of the result (default: by the name of -o, else text)");
    attach_plot(options, request->plot);
    attach_common(options, request->common);
    return [request, &options] { return run(*request, options.command_line()); };
}

}  // namespace

const Command commands::design = {
    .name = "design",
    .summary = "the table of candidate notch filters",
    .description =
        "For each band of joint speed, one notch per order at the frequency f = order * gear ratio * speed / "
        "360 of the\nband's middle speed, with the delay, settling time and worst attenuation that it "
        "costs.\nTable 1 of the paper: ripplenotch design --gear-ratio 100 --orders 1,2 --sample-rate 1kHz "
        "--speed 18:180:18",
    .attach = attach,
};

}  // namespace ripplenotch
