// SPDX-License-Identifier: MIT
// The filters as plain JSON, for programs of one's own: everything the other targets round, unrounded.
#include <fmt/format.h>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

// The JSON library is in the module document, which depends on this one; the output here is this module's own
// text and numbers, so that quoting is all that is needed.
std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e ? '?' : c;
    }
    return out + "\"";
}

std::string list_of(const Biquad& f) {
    return "[" + joined(std::array{f.b0, f.b1, f.b2, 1.0, f.a1, f.a2}, ", ", decimal) + "]";
}

std::string list_of(const SvfSection& s) {
    return "[" + joined(std::array{s.a1, s.a2, s.a3, s.m0, s.m1, s.m2}, ", ", decimal) + "]";
}

std::string section_text(const ExportSection& section, Hertz sample_rate) {
    const auto or_null = [](bool known, double value) {
        return known ? decimal(value) : std::string("null");
    };
    const NotchSpec notch = section.notch.value_or(NotchSpec{});
    const bool is_notch = section.notch.has_value();
    return fmt::format(
        "        {{\"kind\": \"{}\", \"order\": {}, \"center_hz\": {}, \"q\": {}, \"depth_db\": {},\n"
        "         \"sos\": {},\n         \"svf\": {}}}",
        is_notch ? "notch" : "low-pass", section.order ? decimal(section.order->value()) : "null",
        decimal(section.center.value()), or_null(is_notch, notch.q),
        or_null(is_notch && notch.depth_db < infinite_depth_db, notch.depth_db), list_of(section.section),
        list_of(svf_of(section, sample_rate)));
}

std::string band_text(const ExportBand& band, const FilterSet& filters) {
    std::string text = "    {";
    if (filters.by_speed()) {
        text += fmt::format("\"number\": {}, \"speed_from_deg_s\": {}, \"speed_to_deg_s\": {}, ", band.number,
                            decimal(band.from.value()), decimal(band.to.value()));
    }
    text += "\"sections\": [\n";
    text += joined(band.sections, ",\n",
                   [&](const ExportSection& one) { return section_text(one, filters.sample_rate); });
    return text + "\n    ]}";
}

Written write(const FilterSet& filters, const Settings&, std::span<const std::string> heading) {
    std::string text = fmt::format(
        "{{\n  \"schema\": \"ripplenotch/filters/1\",\n  \"tool\": \"{}\",\n  \"version\": \"{}\",\n  "
        "\"made\": [",
        tool_name, version());
    text += joined(heading, ", ", in_quotes);
    text += fmt::format("],\n  \"sample_rate_hz\": {},\n", decimal(filters.sample_rate.value()));
    if (filters.by_speed()) {
        text += fmt::format(
            "  \"gear_ratio\": {},\n  \"below_first_band\": \"{}\",\n  \"above_last_band\": \"{}\",\n"
            "  \"transition\": \"{}\",\n  \"hysteresis_deg_s\": {},\n  \"dwell_samples\": {},\n  "
            "\"crossfade_samples\": {},\n",
            decimal(filters.gear_ratio->value()), outside_rule_name(filters.switching.below),
            outside_rule_name(filters.switching.above), filters.switching.transition,
            decimal(filters.switching.hysteresis.value()), filters.switching.dwell_samples,
            filters.switching.crossfade_samples);
    }
    text +=
        "  \"sos_layout\": \"b0 b1 b2 1 a1 a2: y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2\",\n"
        "  \"svf_layout\": \"a1 a2 a3 m0 m1 m2: v3 = x - s2, v1 = a1 s1 + a2 v3, v2 = s2 + a2 s1 + a3 v3, "
        "s1 = 2 v1 - s1, s2 = 2 v2 - s2, y = m0 x + m1 v1 + m2 v2\",\n"
        "  \"bands\": [\n";
    text += joined(filters.bands, ",\n", [&](const ExportBand& band) { return band_text(band, filters); });
    return {text + "\n  ]\n}\n", {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::none, Precision::float64);
    reader.expect("\"bands\": [");
    const auto enter = [&](const ExportBand&) { reader.expect("\"sections\":"); };
    return read_bands(filters, enter, [&](std::size_t) {
        reader.expect("\"sos\":");
        const auto v = reader.numbers('[', ']', 6);
        if (v[3] != 1.0) reader.fail(shortest(v[3]), "a0 of 1");
        return loaded_row(v.data());
    });
}

}  // namespace

const Target targets::json = {
    .name = "json",
    .summary = "everything, unrounded: sections in both forms, speeds, rules",
    .source = "RFC 8259",
    .endings = ".json",
    .switches = true,
    .runs_supervisor = true,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
