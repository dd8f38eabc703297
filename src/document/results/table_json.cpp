// SPDX-License-Identifier: MIT
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/core/gear_account.hpp"

#include <array>
#include <cmath>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {
namespace {

// Sections must agree to the rounding of one tangent and one cosine in another mathematics library.
constexpr double section_tolerance = 1e-12;
constexpr double figure_tolerance = 1e-6;  // dB, per cent, and a share of the delay

// What a figure depends on may have been edited by hand; then the figure, or the section, would lie.
void compare(const JsonReader& reader, std::string_view name, double stored, double computed,
             double tolerance) {
    if (std::abs(stored - computed) <= tolerance) return;
    raise<DataError>(
        "{} is {}, but the table's own bands and notches give {}; run 'ripplenotch design' again instead of "
        "editing the file",
        reader.where(name), shortest(stored), shortest(computed));
}

// Figures for people, which follow from the notches: written to the digits on which processors agree, and
// compared with what the notches give.
template <class Archive>
void describe_figure(Archive& archive, std::string_view name, double computed,
                     double tolerance = figure_tolerance) {
    if constexpr (Archive::reading)
        compare(archive, name, archive.number(name), computed, tolerance);
    else
        archive(name, computed, fitted);
}

template <class Archive>
void describe_figures(Archive& archive, std::string_view name, const std::vector<double>& computed) {
    if constexpr (Archive::reading) {
        const std::vector<double> stored = archive.numbers(name);
        if (stored.size() != computed.size())
            raise<DataError>("{} has {} entries, expected {}", archive.where(name), stored.size(),
                             computed.size());
        for (std::size_t i = 0; i < stored.size(); ++i)
            compare(archive, fmt::format("{}[{}]", name, i), stored[i], computed[i], figure_tolerance);
    } else {
        archive(name, computed, fitted);
    }
}

// Calls work(), which says UsageError of what is wrong data where it comes from a file.
template <class Work>
void as_data(const std::string& where, const Work& work) {
    try {
        work();
    } catch (const UsageError& error) {
        raise<DataError>("{}: {}", where, error.what());
    }
}

template <class Archive>
void describe_notch(Archive& archive, auto& notch, const TableSpec& spec) {
    archive("order", notch.order);
    archive("center_hz", notch.notch.center);
    archive("q", notch.notch.q);
    auto& depth_db = notch.notch.depth_db;
    const bool limited = archive.known("depth_db", depth_db < infinite_depth_db, depth_db);
    const auto sos_of = [](const Biquad& f) { return std::array{f.b0, f.b1, f.b2, 1.0, f.a1, f.a2}; };
    auto sos = sos_of(notch.section);
    archive("sos", sos);
    if constexpr (Archive::reading) {
        if (!limited) depth_db = infinite_depth_db;
        notch.notch.width = spec.width;
        as_data(archive.place(), [&] { notch.section = design_notch(notch.notch, spec.sample_rate); });
        const auto computed = sos_of(notch.section);
        for (std::size_t i = 0; i < computed.size(); ++i)
            compare(archive, fmt::format("sos[{}]", i), sos[i], computed[i], section_tolerance);
        // The stored digits are what runs, so that a table filters alike on every machine.
        notch.section = {sos[0], sos[1], sos[2], sos[4], sos[5]};
    }
}

template <class Archive>
void describe_band(Archive& archive, auto& band, auto& spec, TableWork& work) {
    archive("number", band.number, Limits{1.0, 1e6});
    archive("speed_from_deg_s", band.from);
    archive("speed_to_deg_s", band.to);
    archive.each(
        "notches", band.notches, [&](Archive& entry, auto& notch) { describe_notch(entry, notch, spec); },
        AtMost{most_orders});
    if constexpr (Archive::reading) {
        archive("settle_band_percent", spec.settle_band_percent);
        as_data(archive.place(), [&] {
            check_ripple(spec);
            work.add(band, spec.settle_band_percent);
            measure_band(band, spec);
        });
    }
    describe_figure(archive, "dc_delay_ms", 1e3 * band.dc_delay.value());
    // Rounding may move the settling time by a sample.
    describe_figure(archive, "settle_ms", 1e3 * band.settle.value(), 1.5e3 / spec.sample_rate.value());
    archive("settle_band_percent", band.settle_band_percent);
    describe_figure(archive, "overshoot_percent", band.overshoot_percent);
    describe_figures(archive, "worst_attenuation_db", band.worst_attenuation_db);
    if (archive.holds("held_attenuation_db", true))
        describe_figure(archive, "held_attenuation_db", band.held_attenuation_db);
    if (archive.holds("predicted_residual_nm", !band.predicted_residual_nm.empty()))
        describe_figures(archive, "predicted_residual_nm", band.predicted_residual_nm);
}

template <class Archive>
void describe_table(Archive& archive, auto& spec, auto&& bands, const DesignNote& note) {
    archive("sample_rate_hz", spec.sample_rate);
    describe_ratio(archive, spec.gear_ratio);
    archive("orders", spec.orders, AtMost{most_orders});
    archive.derived(
        "gear", [&] { return note.gear; }, if_any);
    archive("gear_ratio_error_percent", spec.ratio_error, in_percent, if_any);
    archive("amplitude_nm", spec.amplitude_nm, if_any);
    archive.derived(
        "designed_for", [&] { return note.reason.empty() ? nullptr : &note; }, if_any);
    archive("width", spec.width, Names{width_rule_name, WidthRule::digital});
    archive("hysteresis_deg_s", spec.hysteresis, if_any);
    TableWork work;
    archive.each(
        "bands", bands, [&](Archive& entry, auto& band) { describe_band(entry, band, spec, work); },
        AtMost{max_bands});
    archive("below_first_band", spec.below, Names{outside_rule_name, OutsideRule::fade});
    archive("above_last_band", spec.above, Names{outside_rule_name, OutsideRule::fade});
}

}  // namespace

void describe(JsonWriter& json, const DesignNote& note) {
    json("min_attenuation_db", note.min_attenuation_db);
    json("max_delay_ms", note.max_delay, in_ms);
    json("reason", note.reason);
    json("no_notch_below_deg_s", note.slowest);
}

std::string table_to_json(const CandidateTable& table, const Provenance& provenance, const DesignNote& note) {
    return to_text(document_of("table", provenance, [&](JsonWriter& json) {
        describe_table(json, table.spec(), table.bands(), note);
    }));
}

CandidateTable table_from_json(std::string_view text, const std::string& source) {
    TableSpec spec;
    std::vector<Band> bands;
    read_document(text, source, "table",
                  [&](JsonReader& reader) { describe_table(reader, spec, bands, {}); });
    if (!bands.empty() && !bands.front().notches.empty()) {
        spec.q = bands.front().notches.front().notch.q;
        spec.depth_db = bands.front().notches.front().notch.depth_db;
    }
    std::optional<CandidateTable> table;
    as_data(source, [&] { table = CandidateTable::from_bands(std::move(spec), std::move(bands)); });
    return std::move(*table);
}

CandidateTable load_table(const std::string& path) {
    return table_from_json(read_all(path), input_name(path));
}

bool one_q_a_band(const CandidateTable& table) {
    for (const Band& band : table.bands())
        for (const CandidateNotch& notch : band.notches)
            if (notch.notch.q != band.notches.front().notch.q) return false;
    return true;
}

std::string table_to_csv(const CandidateTable& table) {
    std::string csv = "number,speed_from_deg_s,speed_to_deg_s";
    const std::size_t orders = table.spec().orders.size();
    for (std::size_t i = 1; i <= orders; ++i) csv += fmt::format(",center_{}_hz", i);
    const bool one_q = one_q_a_band(table);
    if (one_q) csv += ",q";
    for (std::size_t i = 1; !one_q && i <= orders; ++i) csv += fmt::format(",q_{}", i);
    csv += ",dc_delay_ms,settle_ms,overshoot_percent";
    for (std::size_t i = 1; i <= orders; ++i) csv += fmt::format(",worst_attenuation_{}_db", i);
    csv += "\n";
    for (const Band& band : table.bands()) {
        csv += fmt::format("{},{},{}", band.number, shortest(band.from.value()), shortest(band.to.value()));
        for (const CandidateNotch& notch : band.notches) csv += "," + shortest(notch.notch.center.value());
        for (std::size_t i = 0; i < (one_q ? 1 : orders); ++i) csv += "," + shortest(band.notches[i].notch.q);
        csv += fmt::format(",{:.3f},{:.3f},{:.3f}", 1e3 * band.dc_delay.value(), 1e3 * band.settle.value(),
                           band.overshoot_percent);
        for (const double worst : band.worst_attenuation_db) csv += fmt::format(",{:.2f}", worst);
        csv += "\n";
    }
    return csv;
}

}  // namespace ripplenotch
