// SPDX-License-Identifier: MIT
#pragma once
// The numbers that a diagnosis decides by. The reason is given where one is known; the others were set on
// logs with numbers below 1000 of scripts/prove-diagnose while the code was written.

#include <cstddef>

namespace ripplenotch::limits {

// The parts of a log that are used.
namespace recording {
/// Longer logs are searched in stretches of so many in all: time grows with it, the values are fitted to the
/// whole.
inline constexpr std::size_t search_samples = 40'000;
inline constexpr std::size_t stretch_samples = 2'000;  ///< length of such a stretch: a move at 1 kHz
/// At the beginning of a stretch effects with a memory do not know what came before.
inline constexpr std::size_t settling_samples = 100;
/// Length of the stretches at the full rate on which delays and lags are screened.
inline constexpr std::size_t block_samples = 240;
/// What a delay brings into the begin of such a stretch is of another one.
inline constexpr std::size_t block_begin = 40;
inline constexpr std::size_t block_end = 10;  ///< the same at its end
/// Stretches of the log in which a spring that all torque passes is tried: it remembers longer.
inline constexpr std::size_t ringing_samples = 1'500;
/// The begin of such a stretch, in which it may ring of another one.
inline constexpr std::size_t ringing_begin = 400;
/// The walk of an integrated position is fitted with so many: the first hold 99 % of it.
inline constexpr std::size_t walk_modes = 20;
/// What is slower tells no phase of a ripple; what an effect without a name leaves is coherent for as long.
inline constexpr double angle_window_s = 0.2;
/// In each direction, added up, from where on a log without position lets effects of the position be tried.
inline constexpr double least_turned_deg = 360.0;
inline constexpr double least_span_deg = 180.0;  ///< if its positions span as much
/// Nearer to a start or stop noise decides what the speed is; twice the default smoothing.
inline constexpr double edge_s = 0.1;
/// What smoothing does to the acceleration: beyond this it is a kink and no noise, and does not count.
inline constexpr double kink_deviations = 6.0;
/// Of the largest acceleration: no smaller kink matters, however quiet the log.
inline constexpr double kink_part = 0.04;
/// Of the fastest speed: slower samples count as resting where direction or speed decides: slow joints exist.
inline constexpr double moving_part = 0.01;
/// No faster sample counts as resting, however fast the joint: the limit that all studies were made with.
inline constexpr double moving_most_deg_s = 1.0;
}  // namespace recording

// Size and colour of the noise.
namespace noise_floor {
/// Longest memory of the noise; a longer one is a torque that something should explain.
inline constexpr std::size_t most_lags = 16;
/// What a further lag has to gain: Akaike's 2 is too little where 16 are tried.
inline constexpr double lag_price = 6.0;
/// So many lines are taken out before noise is measured, or its colour would swallow them.
inline constexpr std::size_t most_lines = 8;
/// Power of such a line; white noise passes 14 in one of a million cells.
inline constexpr double stands_out = 60.0;
/// Of the rms: noise whose quiet stretches have less is none: a resonance is loud in some stretches only.
inline constexpr double unsteady = 0.75;
inline constexpr std::size_t quiet_stretches = 160;  ///< into so many the log is cut to find the quiet ones
/// Of the stretches: share of them that is quieter than the one that counts.
inline constexpr double quiet_part = 0.25;
/// Over the travel, each direction by itself: what the model of far too many terms follows.
inline constexpr std::size_t position_splines = 13;
/// The same over the root of the speed: friction changes most where it is slow.
inline constexpr std::size_t speed_splines = 14;
inline constexpr std::size_t time_splines = 22;  ///< the same over time
/// Of the slowest speed: width of friction's step at standstill, in units of recording.moving.
inline constexpr double step_part = 0.2;
/// Of the noise: a model that leaves less shows that the noise was measured too large, and it is looked at
/// again.
inline constexpr double was_too_large = 0.985;
/// At the noise, each with a search of its own: what was hidden by a noise too large shows then.
inline constexpr std::size_t most_looks = 3;
}  // namespace noise_floor

// Lines of a residual.
namespace lines {
/// Of a spectrum per width of a line: a peak between cells loses 3 % at most.
inline constexpr double oversampling = 4.0;
/// Slower swings are what drift and wandering zeros are made of.
inline constexpr double slowest_tone_hz = 5.0;
/// Per output turn; fewer are matters of gravity and friction.
inline constexpr double fewest_cycles_per_turn = 12.0;
inline constexpr std::size_t most_cells = 1'000'000;  ///< a spectrum ends there: memory and time
/// Of a log's span: where less is recorded, or a spectrum of the whole would be too long, tones are looked
/// for in the mean of the spectra of its pieces.
inline constexpr double recorded_part = 0.5;
inline constexpr double gap_steps = 6.0;  ///< a longer step is a gap between pieces
/// About the mean frequency of the pieces: so far the frequency is looked for at which they are in step.
inline constexpr double agreement_errors = 4.0;
inline constexpr std::size_t agreement_cells = 20'000;  ///< looked at for that, to each side
/// Over so many the median is the background that a line cannot raise.
inline constexpr std::size_t background_cells = 181;
inline constexpr std::size_t fewest_samples = 50;  ///< fewer make no spectrum
inline constexpr double least_range = 1.0;         ///< a shorter log, or less travel, resolves no line
/// Of the fastest speed: orders are looked for up to half the sample rate at this speed: beyond, they are
/// sampled at the slow ends alone.
inline constexpr double moderate_speed = 0.25;
inline constexpr std::size_t most_peaks = 12;  ///< of one spectrum; more peaks are no lines
}  // namespace lines

// The candidates that are tried, and their starting values.
namespace screening {
/// Of the thinned log on which every effect is tried; the fit of the whole decides.
inline constexpr std::size_t sketch_samples = 6'000;
/// Of a column: a column of which less lies outside the model's own is not told by the log.
inline constexpr double least_outside = 0.03;
/// That a log with nothing hidden gets a name: it makes the price. Asked for: one in a hundred.
inline constexpr double false_alarm = 0.01;
inline constexpr std::size_t most_tones = 3;     ///< tones: of the residual, at which a tone may begin
inline constexpr double tone_prominence = 12.0;  ///< a tone below this is not tried
/// Gear ratios that put the ripple on lines of the log, at which a ratio may begin.
inline constexpr std::size_t most_ratios = 3;
/// That a log has to pass in both directions for a friction that goes with the position to be tried.
inline constexpr double least_cycle = 0.55;
inline constexpr std::size_t most_change_times = 2;  ///< at which a payload may begin to change
/// Of the gap: that a change of inertia and gravity has to close by itself: what closes less feeds on
/// something else.
inline constexpr double least_change = 0.4;
inline constexpr double change_within = 0.05;  ///< before the first such time and after the last
/// Of which these are the likeliest; the best are refined.
inline constexpr std::size_t compared_times = 256;
inline constexpr std::size_t change_samples = 20'000;  ///< of the log, by which such times are compared
/// Times the power: that a delay has to give the lines of the best ratio for the two to be tried together.
inline constexpr double late_ratio = 2.0;
inline constexpr double lowest_ratio = 0.4;   ///< of the stated ratio: from where such ratios are compared
inline constexpr double highest_ratio = 2.5;  ///< of the stated ratio: up to where
/// Of the noise's variance: as a sum of squares: models whose torques differ by less are one to a screening,
/// which is not made again. The price of an effect is ten times that and more.
inline constexpr double same_model = 1.0;
}  // namespace screening

// Which effects are added.
namespace search {
/// At most. The studies hide up to three; late ones mend what those before have bent.
inline constexpr std::size_t most_names = 7;
/// An addition may make an earlier one needless, and that one come back.
inline constexpr std::size_t most_additions = 9;
inline constexpr std::size_t finalists = 4;  ///< best of a screening that are fitted on the whole log
/// Of the sum of squares: improvement at which a trial's fit has shown what it is worth.
inline constexpr double finalist_settled = 1e-5;
/// Of the best: a trial that is foreseen to gain less is no finalist.
inline constexpr double within_reach = 0.4;
/// Of the noise's squares: as long as more is unexplained, a step has to close a fair part of it.
inline constexpr double open_gap = 0.02;
inline constexpr double fair_part = 0.12;  ///< of the gap: what closes less only feeds on something else
/// Of the gap: where the first addition leaves more, the finalists are compared by what they come to with one
/// more.
inline constexpr double look_ahead_gap = 0.05;
inline constexpr std::size_t looked_ahead = 2;  ///< of each finalist's screening, that are fitted for it
/// Of the fastest speed: of a friction's step at standstill: over a fifth of the speeds it is friction that
/// grows with the speed. A tenth leaves 3.4 Nm of a UR10's shoulder on rows that nothing was fitted to, a
/// fifth 1.4 Nm.
inline constexpr double widest_step = 0.2;
/// In which each name is tried against what would do in its place.
inline constexpr std::size_t swap_rounds = 2;
inline constexpr double swap_gain = 0.8;  ///< of its gain: a rival that is foreseen to gain less is not tried
inline constexpr std::size_t most_swaps = 2;  ///< tried in place of one name
inline constexpr double swap_margin = 1.0;    ///< gain: by which a rival has to be better to take the place
/// Of its gain: a shape at its bound yields to whatever closes this much of what it closes.
inline constexpr double instead_of_bent = 0.5;
/// Of the moving ripple: ripple that is smaller at rest has the amplitude that it has at the log's usual
/// speed: at rest no log tells it.
inline constexpr double least_at_rest = 0.1;
/// Along 40,000 samples, at which a search ends; three hidden effects in a hundred times take more than a
/// third.
inline constexpr double most_evaluations = 14'000.0;
}  // namespace search

// The requirements for a finding, and its rivals.
namespace judge {
/// Of the noise: a torque below an eighth of the noise is there and does not matter.
inline constexpr double material_sigma = 0.12;
/// Of the noise: the same where steps are coarser than the noise: they bend any torque into shapes of their
/// own.
inline constexpr double material_sigma_of_steps = 0.3;
/// Of its gain: a rival that is foreseen to gain less, and by rival_slack less, is not fitted.
inline constexpr double rival_gain = 0.85;
inline constexpr double rival_slack = 100.0;  ///< a screening foresees no closer than that
/// Fitted in place of one finding; one when the search has ended.
inline constexpr std::size_t most_rivals = 3;
inline constexpr double stretches = 40.0;        ///< stretches: of the log, in which gains are compared
inline constexpr double least_stretch_s = 0.25;  ///< no stretch is shorter
}  // namespace judge

// Whether a finding's size is the same wherever it acts.
namespace evenness {
/// Of its size: real effects of the studies come out up to 20 % uneven, stand-ins 35 to 190 %
/// (docs/commands/diagnose.md).
inline constexpr double most_uneven = 0.3;
/// A place tells a size that it would tell from twice the size by so many.
inline constexpr double telling_deviations = 10.0;
/// Of the noise: where the torque is smaller, a place does not tell its size, however long it is.
inline constexpr double least_sigma = 0.5;
inline constexpr std::size_t times = 8;   ///< places: early and late in the log
inline constexpr std::size_t speeds = 6;  ///< slow and fast, in each direction
/// In which only the change of the torque counts: what differs slowly cannot hide a stand-in.
inline constexpr std::size_t short_stretches = 40;
/// The same for effects that change too slowly for the short ones.
inline constexpr std::size_t long_stretches = 10;
}  // namespace evenness

// Whether a slow finding exceeds the slow drift of the log.
namespace wandering {
/// What a slow finding must explain, against a wave that is a little faster: of flicker noise a trend over
/// the log holds that much in one log of a thousand, and its mean in one of seventy.
inline constexpr double least_above = 150.0;
/// The mean, half a period over the log and a whole one: what is slow.
inline constexpr std::size_t slow_waves = 3;
inline constexpr double slow_part = 0.9;  ///< of its square: must lie in these: then a finding is a slow one
inline constexpr std::size_t waves = 12;  ///< the next ones, which say how the log wanders
}  // namespace wandering

// Whether a fitted shape is the effect's own.
namespace shape {
/// Of the torque: torques that differ by less, whatever their size, are as good as one another.
inline constexpr double as_good = 0.1;
/// Of its range: a value at its bound is held this far within: if the log hardly minds, nothing is bent.
inline constexpr double inward_part = 0.05;
inline constexpr double inward_factor = 2.0;  ///< the same for values that are sizes, above 0
/// Of the critical: a spring that all torque passes swells nothing from here on: it stands in for a delay or
/// a lag.
inline constexpr double most_damping = 0.5;
}  // namespace shape

// Reasons against a finding.
namespace doubt {
/// A torque so many times larger than what it explains is nearly collinear with another.
inline constexpr double most_inflation = 12.0;
/// Of the size: a larger standard error covers the size: it is not identifiable.
inline constexpr double most_error = 0.5;
/// The plain sum of squares has to fall: a gain of the whitened one alone is the noise model's.
inline constexpr double least_closed_nm2 = 0.0;
/// Of the gain: must remain without the finding's best fortieth of the log: a touch is no effect.
inline constexpr double least_elsewhere = 0.2;
/// Of what it explains: where more is left over in the whole log, a finding may have fed on that.
inline constexpr double outgrown = 0.7;
/// Of what it explains: where more is left in one place, of the kind that the finding acts on, it may be part
/// of that.
inline constexpr double casts_doubt = 0.4;
/// Of the larger: a finding smaller than that beside a larger one of its kind may only mend its form.
inline constexpr double shape_part = 0.04;
/// Of the noise: below this, beside a larger one of whatever kind.
inline constexpr double slight_sigma = 0.25;
/// Of the noise: above this a large torque is a finding, however much of it others explain (offset beside
/// gravity and drift).
inline constexpr double stands_sigma = 0.5;
}  // namespace doubt

// The unexplained residual, and where it is.
namespace regions {
/// Many windows, lines and bins are looked at, and noise is never quite what a model of it says.
inline constexpr double significant = 7.0;
/// Of the noise: mean torque of a window or bin that matters there.
inline constexpr double matters_mean = 0.35;
/// On whole steps a torque that stays on one is off by up to half of it.
inline constexpr double matters_mean_steps = 0.55;
/// How much the power of what is left in a window may exceed that of the rest.
inline constexpr double matters_power = 1.6;
/// The same on whole steps, where what is left comes and goes with the torque.
inline constexpr double matters_power_steps = 4.0;
/// Power of a line that is told: thousands of cells are looked at, and a background is never quite white.
inline constexpr double line_prominence = 40.0;
/// Told, one at a time: what is beside a strong line is often its own foot.
inline constexpr std::size_t most_lines = 4;
inline constexpr std::size_t position_bins = 18;  ///< of the travel
inline constexpr std::size_t speed_bins = 20;     ///< bins: of the speeds
inline constexpr double fewest_in_bin = 30.0;     ///< samples: a bin with fewer has no mean
inline constexpr double least_travel_deg = 1.0;   ///< deg: less travel has no bins
/// Times the slowest speed: speeds that differ by less have no bins.
inline constexpr double least_speeds = 1.0;
inline constexpr double shortest_window_s = 0.1;     ///< s: windows of four lengths are looked at: a touch,
inline constexpr double short_window_s = 0.25;       ///< a stop,
inline constexpr double long_window_s = 0.6;         ///< part of a move,
inline constexpr double longest_window_s = 1.5;      ///< a move; longer ones are told by their parts
inline constexpr std::size_t fewest_in_window = 12;  ///< no window is shorter
inline constexpr std::size_t most_windows = 400;     ///< windows: kept; more make no story
/// Of the log: what takes less time is set aside, and the rest diagnosed without it.
inline constexpr double confined_part = 0.1;
/// Of the log: when more is disturbed, nothing is: it is no disturbance of short duration.
inline constexpr double most_aside_part = 0.15;
inline constexpr double aside_margin_s = 0.05;  ///< set aside to both sides of it
inline constexpr std::size_t most_asides = 2;   ///< times: each costs a search of the rest from the start
}  // namespace regions

// Where a finding acts; reported, not used for decisions.
namespace place {
inline constexpr std::size_t bins = 20;        ///< bins: of time, speed and position
inline constexpr double fewest_in_bin = 20.0;  ///< of a bin with fewer nothing is known
/// Of the largest: power of the torque in bins where it acts: half of the largest rms.
inline constexpr double large_power = 0.25;
inline constexpr double most_bins = 0.75;     ///< of the bins: what acts in more acts nowhere in particular
inline constexpr double one_way_power = 4.0;  ///< of one direction over the other's, to act in that one
inline constexpr double least_speeds = 1.0;   ///< times the slowest speed: speeds that differ by less are one
inline constexpr double least_travel_deg = 5.0;  ///< less travel is one position
}  // namespace place

// A log that nothing was fitted to.
namespace reproduction {
/// Of what is left without it: a finding that leaves more of the validation log is withdrawn, and the newest
/// until the whole does no worse.
inline constexpr double most_left = 1.0;
}  // namespace reproduction

// Where more than noise is left: names are weighed against a noise that holds it
// (docs/decisions/0026-one-engine.md).
namespace residual {
inline constexpr double memory_s = 0.2;  ///< how long the residual remembers, as its autoregression is fitted
/// Of its power: white noise that is taken to be in it, or a low-passed log is judged in a band where it
/// holds nothing.
inline constexpr double color_floor = 1e-3;
/// In such blocks gains are counted; at least five memories of the colour.
inline constexpr double block_s = 1.0;
/// Of the gain over blocks: below, a few blocks bring it; one-sided 7 % of a gain that is none. Ripple of
/// real joints comes to 1.7 where it is fast enough in some blocks only.
inline constexpr double least_t = 1.5;
/// Of its size: the same as in evenness, where the residual of a known torque is in every place as well.
inline constexpr double most_uneven = 0.5;
/// Of the floor: from so much residual on it is part of the noise.
inline constexpr double least_left = 1.15;
}  // namespace residual

// The reported values, and the gap.
namespace values {
/// By which intervals are widened: of prove-diagnose --physics, numbers 2 and 3, 91 % held the truth without.
inline constexpr double interval_factor = 1.25;
/// Of the blocks of the errors' sandwich: longer than what smoothing ties together, several to a move.
inline constexpr double error_stretch_s = 0.25;
/// Of the noise: a torque nearer to the end of the converter's range is cut on one side only, and does not
/// count.
inline constexpr double limit_deviations = 4.0;
/// A log of which not one in so many is farther away has to be taken as it is.
inline constexpr std::size_t least_inside = 10;
/// Of the noise's square: a smaller gap is none to speak of: no part of it is said to be closed.
inline constexpr double least_gap = 0.02;
}  // namespace values

// What to do next: the motion that a log lacks.
namespace advice {
/// A direction, rests, or slow motion that has less of the log is asked for.
inline constexpr double least_part = 0.05;
/// Of the fastest speed: up to here motion is slow: kinds of friction part there.
inline constexpr double slow_part = 0.2;
inline constexpr double turn_deg = 360.0;  ///< a smaller travel does not tell effects of the position apart
}  // namespace advice

}  // namespace ripplenotch::limits
