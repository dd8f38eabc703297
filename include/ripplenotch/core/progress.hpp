// SPDX-License-Identifier: MIT
#pragma once
// How far long work has come. Whoever works writes it down here in passing; whoever wants to show it looks at
// it from another thread. Nobody needs to hand a callback through the rooms, and nobody waits.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace ripplenotch {

inline constexpr std::string_view tool_name = "ripplenotch";
[[nodiscard]] std::string_view version();

class Progress {
  public:
    /// One stage of the work; `total` 0 when nobody knows.
    struct State {
        const char* what = "";
        const char* unit = "";
        std::uint64_t done = 0, total = 0;
        unsigned stage = 0;  ///< counts the stages, so that a rate is not taken across two
    };

    /// That of this process.
    [[nodiscard]] static Progress& current();

    /// A stage begins; `what` ("reading") and `unit` ("B", "rows") are literals.
    void begin(const char* what, const char* unit, std::uint64_t total) noexcept;
    void add(std::uint64_t done) noexcept { done_.fetch_add(done, std::memory_order_relaxed); }
    [[nodiscard]] State state() const noexcept;

    /// Called by everything that is about to write to the terminal, so that what shows the progress steps
    /// aside.
    void step_aside() noexcept;
    void on_step_aside(void (*hide)()) noexcept { hide_ = hide; }

  private:
    std::atomic<const char*> what_{""}, unit_{""};
    std::atomic<std::uint64_t> done_{0}, total_{0};
    std::atomic<unsigned> stage_{0};
    std::atomic<void (*)()> hide_{nullptr};
};

/// "filter: reading [=====>     ]  45 %  12.3 MB/s  3 s left" in at most `columns` characters; without a
/// total the time spent so far. `stage_time` is how long the stage runs.
[[nodiscard]] std::string progress_line(std::string_view command, const Progress::State& state,
                                        std::chrono::duration<double> stage_time, int columns);

}  // namespace ripplenotch
