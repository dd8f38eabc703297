// SPDX-License-Identifier: MIT
#pragma once
// A filter method is a record: one file in src/filter/methods, one line in methods.def. Law tests run over
// the list.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

/// Consecutive samples of one joint; spans of equal length, position may be empty.
struct Samples {
    std::span<const double> velocity_deg_s, torque_nm, position_deg;
};

/// One change of filter while running.
struct Switch {
    std::size_t sample = 0;  ///< counted from the first sample given to the filter
    int from_band = 0;       ///< band number, 0 for no filter
    int to_band = 0;
    double speed_deg_s = 0.0;
    double jump_nm = 0.0;  ///< output now minus what the old filter would have put out at this sample
};

/// How many changes a filter lists; later ones are only counted, so that a chattering log takes bounded
/// memory.
inline constexpr std::size_t most_listed_switches = 100000;

/// A running filter of one joint. Causal: output k depends on inputs 0..k only. The first sample after
/// construction and after restart() starts in the steady state of a constant input, so a constant torque
/// passes unchanged, bit for bit.
class CausalFilter {
  public:
    virtual ~CausalFilter() = default;
    /// Filters `in` into `out` (same length; may not overlap). Any split into blocks gives the same bytes.
    virtual void process(const Samples& in, std::span<double> out) = 0;
    /// Forgets the past: the next sample starts settled (after a gap in time).
    virtual void restart() = 0;
    /// Changes of filter since construction, oldest first, at most most_listed_switches of them; empty for
    /// methods that do not switch. The first choice of a run is no change.
    [[nodiscard]] virtual std::span<const Switch> switches() const { return {}; }
    /// How many changes there were, listed or not.
    [[nodiscard]] virtual std::size_t switch_count() const { return switches().size(); }
};

/// What a filter would do to a small torque signal at one constant speed, for delay and attenuation figures.
struct FrozenFilter {
    Cascade cascade;
    std::string note;  ///< e.g. "band 5: 90-108 deg/s", "no band: passes"
    /// The filter also moves to where it takes the ripple to be, so that it is linear only while it is right.
    bool follows_ripple = false;
};

/// The part of a method in a comparison.
enum class MethodPart {
    contender,
    rival,    ///< the filter of joints without this tool: contenders are compared with it
    control,  ///< passes the torque; is in every comparison
};

/// One design of the same coefficients at every speed: notches in series, or a low-pass.
using SteadyDesign = std::variant<std::vector<NotchSpec>, LowPassSpec>;

/// What decides which settings of a method are worth trying on a log.
struct TrialConditions {
    const GearAccount& gear;
    Hertz sample_rate, update_rate;  ///< of the rows, and of the torque in them
    DegPerSec slowest, median, fastest;
    std::string map;  ///< file of the log's ripple map; empty where it has none

    [[nodiscard]] Hertz line(std::size_t order, DegPerSec speed) const {
        return ripple_frequency(gear.orders[order], gear.ratio, speed);
    }
};

struct Trial {
    std::string settings;                 ///< what follows the name where it is typed: ",q=1"
    std::optional<TableSpec> table = {};  ///< to be designed, for the file that the settings name
};

struct Trials {
    std::vector<Trial> all;
    std::string none_because = {};  ///< a clause; empty where there are some
};

/// Multiplications and divisions of a cosine and a sine of one angle.
inline constexpr double circle_multiplications = 22.0;
/// The same of a second-order section.
inline constexpr double section_multiplications = 5.0;

struct Method {
    std::string_view name, summary, source;
    std::string_view noun;  ///< in a sentence: "a tracking notch"
    MethodPart part = MethodPart::contender;
    std::span<const Key> keys;
    bool needs_table = false;  ///< the key "table" names a table.json, loaded by the caller
    bool is_map = false;       ///< all that it does is in its map, which is what is exported of it
    /// `table` is null unless needs_table. Throws UsageError on what cannot be designed at this sample rate.
    std::unique_ptr<CausalFilter> (*start)(const Settings& settings, Hertz sample_rate,
                                           const CandidateTable* table) = nullptr;
    /// The active linear filter at a constant speed; empty function for methods that have none.
    FrozenFilter (*frozen)(const Settings& settings, Hertz sample_rate, const CandidateTable* table,
                           DegPerSec speed) = nullptr;
    bool frozen_is_dear = false;  ///< frozen() is too slow to be called for every window of a log
    /// What can be exported as coefficients; null for methods whose coefficients change while they run.
    SteadyDesign (*steady)(const Settings& settings) = nullptr;
    /// The numbers that exported code of it runs on; null where there is none. Throws UsageError for settings
    /// that no code is written for.
    RunningDesign (*running)(const Settings& settings, Hertz sample_rate) = nullptr;
    /// Settings worth trying on a log; null: it is tried as it is.
    Trials (*trials)(const TrialConditions& log) = nullptr;
    /// Multiplications and divisions in a sample of a moving joint, as its runtime has them; null: none.
    double (*multiplications)(const Settings& settings, const CandidateTable* table) = nullptr;
};

[[nodiscard]] std::span<const Method* const> methods();
/// Throws UsageError with the nearest name.
[[nodiscard]] const Method& find_method(std::string_view name);

}  // namespace ripplenotch
