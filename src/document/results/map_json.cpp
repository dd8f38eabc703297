// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/matrices/least_squares.hpp"
#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_speeds = 64, max_map_orders = 64;

// How many numbers a list may hold, which rise, the first from `least` on.
struct Rising {
    double least;
    std::size_t fewest, most;
};

template <class Archive>
void describe_rising(Archive& archive, std::string_view name, auto& values, const Rising& rising) {
    archive(name, values);
    if constexpr (Archive::reading) {
        using Entry = std::remove_cvref_t<decltype(values.front())>;
        const bool rises = std::is_sorted(values.begin(), values.end(), std::less_equal<>());
        if (values.size() < rising.fewest || values.size() > rising.most || !rises ||
            (!values.empty() && !(values.front() >= Entry(rising.least))))
            raise<DataError>("{} is not {} to {} numbers from {} on, each above the one before",
                             archive.where(name), rising.fewest, rising.most, rising.least);
    }
}

// A value of the map with its error, a row each, so that a page shows a table.
struct Coefficient {
    double order = 0.0;
    std::string column;
    std::complex<double> value, error;
};

}  // namespace

auto ends_of(Is<MapRange> auto& range) { return std::tie(range.from, range.to); }

template <class Archive>
void describe(Archive& archive, Is<Coefficient> auto& one) {
    archive.derived("order", [&] { return one.order; });
    archive.derived("column", [&] { return one.column; });
    double cosine_error = one.error.real(), sine_error = one.error.imag(), cosine = one.value.real(),
           sine = one.value.imag();
    archive("cosine_nm", cosine);
    archive("cosine_ci95_nm", cosine_error, Times{normal_95_errors});
    archive("sine_nm", sine);
    archive("sine_ci95_nm", sine_error, Times{normal_95_errors});
    if constexpr (Archive::reading) one = {0.0, {}, {cosine, sine}, {cosine_error, sine_error}};
}

template <class Archive>
void describe(Archive& archive, Is<MapForm> auto& form) {
    archive.derived("words", [&] { return map_form_words(form); });
    describe_rising(archive, "speeds_deg_s", form.speeds_deg_s, {0.0, 1, most_speeds});
    archive("directions", form.directions, Limits{1, 2});
    if (!archive.holds("second_comb", form.second_comb != 0)) return;
    if constexpr (Archive::reading) {
        const double side = archive.number("second_comb");
        if (std::abs(side) != 1.0)
            raise<DataError>("{} is {}, expected 1 or -1", archive.where("second_comb"), side);
        form.second_comb = side > 0.0 ? 1 : -1;
    } else {
        archive("second_comb", form.second_comb);
    }
}

void describe(auto& archive, Is<MapOrderScore> auto& score) {
    archive("order", score.order);
    archive("in_map", score.in_map);
    archive("ripple_nm", score.ripple_nm);
    archive("noise_nm", score.noise_nm);
    archive("left_nm", score.left_nm);
    archive("predicted_share", score.predicted_share);
    archive("false_alarm", score.false_alarm, if_there);
    if (archive.holds("detectable_nm", !score.in_map && std::isfinite(score.detectable_nm)))
        archive("detectable_nm", score.detectable_nm);
}

void describe(auto& archive, Is<MapAgreement> auto& one) {
    archive("log", one.log);
    archive("order", one.order);
    archive("amplitude_ratio", one.amplitude_ratio);
    archive("amplitude_error", one.amplitude_error);
    archive("phase_deg", one.phase_deg);
    archive("phase_error_deg", one.phase_error_deg);
    archive("agrees", one.agrees);
}

namespace {

template <class Archive>
void describe_coefficients(Archive& archive, auto& fit) {
    auto& map = fit.map;
    std::vector<Coefficient> all;
    for (std::size_t i = 0; i < map.values.size(); ++i)
        for (std::size_t c = 0; c < map.values[i].size(); ++c)
            all.push_back(
                {map.orders[i].value(), map_column_words(map.form, c), map.values[i][c], fit.errors[i][c]});
    archive("coefficients", all);
    if constexpr (Archive::reading) {
        const std::size_t columns = map.form.columns();
        if (all.size() != columns * map.orders.size())
            raise<DataError>("{}: {} values, expected {} for each of {} orders",
                             archive.where("coefficients"), all.size(), columns, map.orders.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (i % columns == 0) {
                map.values.emplace_back();
                fit.errors.emplace_back();
            }
            map.values.back().push_back(all[i].value);
            fit.errors.back().push_back(all[i].error);
        }
    }
}

std::string_view angle_name(bool anchored) { return anchored ? "position" : "integrated velocity"; }

}  // namespace

template <class Archive>
void describe_map(Archive& archive, auto& fit) {
    auto& map = fit.map;
    archive.derived("verdict", [&] { return map_verdict(fit); });
    archive("finding", fit.finding, Names{map_finding_name, MapFinding::too_little});
    archive("doubt", fit.doubt);
    archive("conclusive", fit.conclusive);
    archive("joint", map.joint);
    describe_ratio(archive, map.gear_ratio);
    archive("zero_deg", map.zero_deg);
    std::string angle(angle_name(fit.anchored));
    archive("angle", angle);
    if constexpr (Archive::reading) fit.anchored = angle == angle_name(true);
    archive("form", map.form);
    archive.group("range", [&](Archive& range) {
        range("speed_deg_s", map.speeds_deg_s, lower_first);
        range("position_deg", map.positions_deg, lower_first);
    });
    describe_rising(archive, "orders", map.orders, {1e-9, 0, max_map_orders});
    archive("spread_nm", map.spread_nm);
    if constexpr (Archive::reading) {
        if (map.spread_nm.size() != map.orders.size())
            raise<DataError>("{}: {} numbers for {} orders", archive.where("spread_nm"), map.spread_nm.size(),
                             map.orders.size());
    }
    describe_coefficients(archive, fit);
    archive("left_out", fit.scores);
    archive("agreement", fit.agreement);
    archive("windows", fit.windows);
    archive("blocks", fit.blocks);
    archive("notes", fit.notes);
    if (!archive.holds("others", !fit.others.empty())) return;
    archive("others", fit.others);
    if constexpr (Archive::reading) {
        for (const MapFit& other : fit.others)
            if (!other.map.orders.empty() && other.doubt.empty()) map.others.push_back(other.map);
    }
}

void describe(JsonWriter& json, const MapFit& fit) { describe_map(json, fit); }

void describe(JsonReader& reader, MapFit& fit) { describe_map(reader, fit); }

std::string map_text(const MapFit& fit, const Provenance& provenance) {
    return to_fitted_text(document_of("map", provenance, fit));
}

MapFit map_from_json(std::string_view text, const std::string& source) {
    return result_of<MapFit>(text, source, "map");
}

MapFit load_map(const std::string& path) { return map_from_json(read_all(path), input_name(path)); }

bool is_document(const std::string& path, std::string_view kind) {
    constexpr std::size_t head = 200;
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return false;
    const std::string schema = "ripplenotch/" + std::string(kind) + "/1";
    return read_all(path).substr(0, head).find(schema) != std::string::npos;
}

}  // namespace ripplenotch
