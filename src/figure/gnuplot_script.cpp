// SPDX-License-Identifier: MIT
#include "figure/gnuplot_script.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <string_view>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

extern char** environ;  // NOLINT: POSIX names it so

namespace ripplenotch {
namespace {

// Both ends close with the object.
class Pipe {
  public:
    Pipe() {
        if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
            raise<FileError>("cannot make a pipe to gnuplot: {}", std::strerror(errno));
    }
    ~Pipe() {
        close_read();
        close_write();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    [[nodiscard]] int read_end() const { return ends_[0]; }
    [[nodiscard]] int write_end() const { return ends_[1]; }
    void close_read() { close(ends_[0]); }
    void close_write() { close(ends_[1]); }

  private:
    static void close(int& end) {
        if (end >= 0) ::close(end);
        end = -1;
    }
    std::array<int, 2> ends_{-1, -1};
};

// A child that has gone away must not take us with it: its complaint is still to be read.
class IgnoreBrokenPipe {
  public:
    IgnoreBrokenPipe() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
    ~IgnoreBrokenPipe() { std::signal(SIGPIPE, before_); }
    IgnoreBrokenPipe(const IgnoreBrokenPipe&) = delete;
    IgnoreBrokenPipe& operator=(const IgnoreBrokenPipe&) = delete;

  private:
    void (*before_)(int);
};

// Ours, without what changes how gnuplot draws.
std::vector<std::string> plain_environment() {
    // A PDF holds its time zone too. cairo from 1.18 on packs the clock into a stream, where same_pdf()
    // cannot reach it, unless it writes nothing packed: a third more bytes.
    std::vector<std::string> kept{"LC_ALL=C", "TZ=UTC0", "CAIRO_DEBUG_PDF=1"};
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view name(*entry);
        bool ours = false;
        for (const std::string_view changes :
             {"LC_", "LANG=", "LANGUAGE=", "TZ=", "GNU", "GDFONTPATH=", "FIT_", "CAIRO_"})
            ours = ours || name.substr(0, changes.size()) == changes;
        if (!ours) kept.emplace_back(name);
    }
    return kept;
}

// gnuplot, or -1 when there is none.
pid_t start(const Pipe& in, const Pipe& out, const Pipe& complaints) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in.read_end(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out.write_end(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, complaints.write_end(), STDERR_FILENO);
    std::string name = "gnuplot", no_settings = "--default-settings", from_pipe = "-";
    std::array<char*, 4> words{name.data(), no_settings.data(), from_pipe.data(), nullptr};
    std::vector<std::string> kept = plain_environment();
    std::vector<char*> environment;
    for (std::string& entry : kept) environment.push_back(entry.data());
    environment.push_back(nullptr);
    pid_t child = -1;
    const int failed =
        ::posix_spawnp(&child, name.c_str(), &actions, nullptr, words.data(), environment.data());
    posix_spawn_file_actions_destroy(&actions);
    if (failed == ENOENT || failed == ENOTDIR || failed == EACCES) return -1;
    if (failed != 0) raise<FileError>("cannot start gnuplot: {}", std::strerror(failed));
    return child;
}

// Appends what is there; false at the end.
bool read_some(int from, std::string& to) {
    std::array<char, 65536> buffer;  // NOLINT: filled by read
    const ssize_t got = ::read(from, buffer.data(), buffer.size());
    if (got < 0) return errno == EINTR;
    to.append(buffer.data(), static_cast<std::size_t>(got));
    return got > 0;
}

// Feeds and listens at once: either side may have more to say than a pipe holds.
void converse(const std::string& script, Pipe& in, Pipe& out, Pipe& complaints, std::string& printed,
              std::string& complained) {
    std::size_t given = 0;
    ::fcntl(in.write_end(), F_SETFL, O_NONBLOCK);
    while (out.read_end() >= 0 || complaints.read_end() >= 0) {
        std::array<pollfd, 3> ends{pollfd{in.write_end(), POLLOUT, 0}, pollfd{out.read_end(), POLLIN, 0},
                                   pollfd{complaints.read_end(), POLLIN, 0}};
        if (::poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) break;
        if (ends[0].revents != 0) {
            const ssize_t took = ::write(in.write_end(), script.data() + given, script.size() - given);
            if (took > 0) given += static_cast<std::size_t>(took);
            const bool gone = took < 0 && errno != EAGAIN && errno != EINTR;
            if (gone || given == script.size()) in.close_write();
        }
        if (ends[1].revents != 0 && !read_some(out.read_end(), printed)) out.close_read();
        if (ends[2].revents != 0 && !read_some(complaints.read_end(), complained)) complaints.close_read();
    }
}

}  // namespace

std::optional<std::string> run_gnuplot(const std::string& script) {
    Pipe in, out, complaints;
    const IgnoreBrokenPipe ignore;
    const pid_t child = start(in, out, complaints);
    if (child < 0) return std::nullopt;
    in.close_read();
    out.close_write();
    complaints.close_write();
    std::string printed, complained;
    converse(script, in, out, complaints, printed, complained);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    // POSIX lets posix_spawn tell only so that nothing was started; it does under an emulator.
    constexpr int not_started = 127;
    if (WIFEXITED(status) && WEXITSTATUS(status) == not_started && printed.empty() && complained.empty())
        return std::nullopt;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        raise<FileError>("gnuplot could not draw the figure and said: {}",
                         complained.substr(0, complained.find_last_not_of(" \n") + 1));
    }
    return printed;
}

}  // namespace ripplenotch

namespace ripplenotch {

namespace {

bool harmless(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view(" ,.:;()/+=-").find(c) != std::string_view::npos;
}

}  // namespace

std::string gnuplot_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : visible_text(text)) {
        if (harmless(c)) {
            quoted += c;
        } else {
            quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
        }
    }
    return quoted + "\"";
}

std::string GnuplotScript::open_block() {
    const std::string name = fmt::format("$d{}", blocks_++);
    line("{} << END_OF_BLOCK", name);
    return name;
}

std::string GnuplotScript::rows(const std::vector<const std::vector<double>*>& columns) {
    std::string name = open_block();
    for (std::size_t i = 0; i < columns.front()->size(); ++i) {
        const bool whole = std::all_of(columns.begin(), columns.end(),
                                       [i](const auto* c) { return std::isfinite((*c)[i]); });
        for (const auto* column : columns) {
            if (whole) fmt::format_to(std::back_inserter(text_), "{:.8g} ", (*column)[i]);
        }
        text_ += '\n';
    }
    line("END_OF_BLOCK");
    return name;
}

std::string GnuplotScript::cells(const HeatMap& map, std::string_view levels) {
    std::string name = open_block();
    const std::size_t across = map.x_edges.size() - 1;
    const PlotRange colours{map.lowest, map.highest};
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
        if (std::isnan(map.cells[i])) continue;
        const double share = share_along(colours, map.scale, within_colours(map, map.cells[i]));
        const auto level = static_cast<std::size_t>(share * 0.9999 * static_cast<double>(levels.size()));
        if (levels[level] == ' ') continue;
        const std::size_t column = i % across, row = i / across;
        line("{:.8g} {:.8g} \"{}\"", 0.5 * (map.x_edges[column] + map.x_edges[column + 1]),
             0.5 * (map.y_edges[row] + map.y_edges[row + 1]), levels[level]);
    }
    line("END_OF_BLOCK");
    return name;
}

std::string GnuplotScript::matrix(const HeatMap& map) {
    std::string name = open_block();
    const std::size_t across = map.x_edges.size() - 1;
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
        const double value = within_colours(map, map.cells[i]);
        text_ += std::isnan(value) ? "NaN" : fmt::format("{:.5g}", value);
        text_ += (i + 1) % across == 0 ? '\n' : ' ';
    }
    line("END_OF_BLOCK");
    return name;
}

std::string gnuplot_ticks(const PlotRange& range, PlotScale scale) {
    constexpr double few_decades = 2.3;
    if (scale == PlotScale::whole) return fmt::format("{:g}", whole_step(range));
    if (scale == PlotScale::linear || portable::log10(range.to / range.from) > few_decades) return "";
    std::string ticks;
    for (int decade = static_cast<int>(std::floor(portable::log10(range.from)));
         decade <= portable::log10(range.to); ++decade) {
        for (const double step : {1.0, 2.0, 5.0}) {
            const double value = step * portable::pow(10.0, decade);
            if (value < range.from || value > range.to) continue;
            ticks += fmt::format("{}{:.6g}", ticks.empty() ? "" : ", ", value);
        }
    }
    return ticks.empty() ? "" : "(" + ticks + ")";
}

double within_colours(const HeatMap& map, double value) {
    return std::isnan(value) ? value : std::clamp(value, map.lowest, map.highest);
}

bool segment_of(const NamedLine& line, const PlotRange& x, const PlotRange& y, Segment& segment) {
    if (line.run == NamedLine::Run::at_x) {
        segment = {line.value, y.from, line.value, y.to};
        return line.value >= x.from && line.value <= x.to;
    }
    if (line.run == NamedLine::Run::at_y) {
        segment = {x.from, line.value, x.to, line.value};
        return line.value >= y.from && line.value <= y.to;
    }
    // A ray through the origin of slope value, from where it enters to where it leaves.
    double from = x.from, to = x.to;
    if (line.value != 0.0) {
        const double a = y.from / line.value, b = y.to / line.value;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    } else if (y.from > 0.0 || y.to < 0.0) {
        return false;
    }
    segment = {from, line.value * from, to, line.value * to};
    return from < to;
}

}  // namespace ripplenotch
