// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/ranges.h>
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

#include "figure/gnuplot_picture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"

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

// Appends the available bytes; false at the end.
bool read_some(int from, std::string& to) {
    std::array<char, 65536> buffer;  // NOLINT: filled by read
    const ssize_t got = ::read(from, buffer.data(), buffer.size());
    if (got < 0) return errno == EINTR;
    to.append(buffer.data(), static_cast<std::size_t>(got));
    return got > 0;
}

// Writes and reads at once: either side may have more data than a pipe holds.
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
    // POSIX lets posix_spawn report only that nothing was started; it does under an emulator.
    constexpr int not_started = 127;
    if (WIFEXITED(status) && WEXITSTATUS(status) == not_started && printed.empty() && complained.empty())
        return std::nullopt;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        raise<FileError>("gnuplot could not draw the figure and reported: {}",
                         complained.substr(0, complained.find_last_not_of(" \n") + 1));
    }
    return printed;
}

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

void GnuplotScript::axis(std::string_view name, const PlotAxis& axis, const PlotRange& range) {
    line("set {}range [{:.10g}:{:.10g}]", name, range.from, range.to);
    if (axis.scale == PlotScale::logarithmic) line("set logscale {}", name);
    if (const std::string ticks = gnuplot_ticks(range, axis.scale); !ticks.empty())
        line("set {}tics {}", name, ticks);
}

void GnuplotScript::plot(const std::vector<std::string>& parts) { line("plot {}", fmt::join(parts, ", ")); }

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

std::optional<Segment> segment_of(const NamedLine& line, const PlotRange& x, const PlotRange& y) {
    if (line.run == NamedLine::Run::at_x) {
        if (!(line.value >= x.from && line.value <= x.to)) return std::nullopt;
        return Segment{line.value, y.from, line.value, y.to, true};
    }
    if (line.run == NamedLine::Run::at_y) {
        if (!(line.value >= y.from && line.value <= y.to)) return std::nullopt;
        return Segment{x.from, line.value, x.to, line.value, false};
    }
    // A ray through the origin of slope value, within the panel.
    double from = x.from, to = x.to;
    if (line.value != 0.0) {
        const double a = y.from / line.value, b = y.to / line.value;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    } else if (y.from > 0.0 || y.to < 0.0) {
        return std::nullopt;
    }
    if (!(from < to)) return std::nullopt;
    const double end = line.value * to;
    return Segment{from, line.value * from, to, end,
                   end >= y.to - 1e-9 * (y.to - y.from) && to < x.to - 1e-9 * (x.to - x.from)};
}

namespace {

// Figures in characters: gnuplot's dumb terminal draws the axes and curves, names and lists go below as text.

constexpr int rows_of_panel = 20;
constexpr double plot_rows = rows_of_panel - 4.0;
constexpr std::string_view curve_characters = "*#$%@&=";  // characters of gnuplot's line types 1, 2, ...
constexpr std::string_view level_characters = " .:-=+*%@";
constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr std::size_t left_columns = 11;  // for the numbers of the y axis

std::string without_blank_ends(const std::string& text) {
    std::string result, line;
    const auto close = [&] {
        const std::size_t last = line.find_last_not_of(" \f\r");
        line.resize(last == std::string::npos ? 0 : last + 1);
        if (!line.empty()) result += line + "\n";
        line.clear();
    };
    for (const char c : text) {
        if (c == '\n') {
            close();
        } else if (c != '\f') {
            line += c;
        }
    }
    close();
    return result;
}

// One panel as gnuplot draws it.
class TextPanel {
  public:
    TextPanel(const Panel& panel, int columns)
        : panel_(panel), columns_(columns), x_(x_range(panel)), y_(y_range(panel)) {}

    [[nodiscard]] std::optional<std::string> draw() {
        script_.line("set encoding utf8\nset terminal dumb noenhanced size {},{}", columns_, rows_of_panel);
        script_.line(
            "set lmargin {}\nset rmargin 3\nset tmargin 1\nset bmargin 2\nset border 3\nset tics nomirror",
            left_columns);
        script_.line("unset key");
        script_.axis("x", panel_.x, x_);
        script_.axis("y", panel_.y, y_);
        script_.line("set format x '%.5g'\nset format y '%.5g'");
        std::vector<std::string> parts;
        if (panel_.map) {
            const HeatMap raster =
                rasterised(*panel_.map, x_, panel_.x.scale, y_, panel_.y.scale,
                           {.columns = static_cast<std::size_t>(columns_) - left_columns - 4,
                            .rows = static_cast<std::size_t>(rows_of_panel) - 4});
            parts.push_back(script_.cells(raster, level_characters) + " using 1:2:3 with labels");
        }
        for (std::size_t i = 0; i < panel_.curves.size(); ++i) draw(panel_.curves[i], i, parts);
        mark_lines();
        if (parts.empty()) parts.emplace_back("NaN");
        script_.plot(parts);
        const auto drawn = run_gnuplot(script_.text());
        if (!drawn) return std::nullopt;
        return heading() + without_blank_ends(*drawn) + below();
    }

  private:
    void draw(const Curve& whole, std::size_t i, std::vector<std::string>& parts) {
        const Curve curve = thinned(whole, static_cast<std::size_t>(columns_));
        const std::string data = script_.rows({&curve.x, &curve.y});
        const std::size_t type = i % curve_characters.size() + 1;
        if (curve.style == CurveStyle::points || curve.style == CurveStyle::crosses) {
            // A point is the character of its curve, which "with points" would not give.
            parts.push_back(
                fmt::format("{} using 1:2:(\"{}\") with labels", data, curve_characters[type - 1]));
            return;
        }
        const char* how = curve.style == CurveStyle::steps   ? "steps"
                          : curve.style == CurveStyle::stems ? "impulses"
                                                             : "lines";
        parts.push_back(fmt::format("{} using 1:2 with {} lt {}", data, how, type));
    }

    // A letter where each line meets the edge of the panel, none on top of another; rays and levels are
    // dotted on the way.
    void mark_lines() {
        std::vector<std::size_t> above, beside;
        std::vector<double> columns, rows;
        for (const NamedLine& line : panel_.lines) {
            const auto s = segment_of(line, x_, y_);
            if (named_.size() == letters.size() || !s) continue;
            const bool on_top = line.run == NamedLine::Run::at_x;
            (on_top ? above : beside).push_back(named_.size());
            if (on_top) {
                columns.push_back(plot_columns() * share_along(x_, panel_.x.scale, s->x1));
            } else {
                rows.push_back(plot_rows * share_along(y_, panel_.y.scale, s->y1));
                // Dots only where nothing else is drawn that they would hide.
                if (!panel_.map) dots(*s);
            }
            named_.push_back(&line);
        }
        columns = pushed_apart(columns, 2.0, 0.0, plot_columns());
        rows = pushed_apart(rows, 1.0, 0.0, plot_rows);
        for (std::size_t i = 0; i < above.size(); ++i)
            script_.line("set label \"{}\" at graph {:.6g},1 center front", letters[above[i]],
                         columns[i] / plot_columns());
        for (std::size_t i = 0; i < beside.size(); ++i)
            script_.line("set label \"{}\" at graph 1,{:.6g} offset 1,0 center front", letters[beside[i]],
                         rows[i] / plot_rows);
    }

    [[nodiscard]] double plot_columns() const { return static_cast<double>(columns_) - left_columns - 4.0; }

    void dots(const Segment& s) {
        const int count = columns_ / 3;
        for (int i = 1; i < count; ++i) {
            const double share = static_cast<double>(i) / count;
            script_.line("set label \".\" at {:.10g},{:.10g} center back", s.x0 + share * (s.x1 - s.x0),
                         s.y0 + share * (s.y1 - s.y0));
        }
    }

    [[nodiscard]] std::string lines_of(const std::string& words) const {
        std::string text;
        for (const std::string& line : wrapped(words, static_cast<std::size_t>(columns_)))
            text += line + "\n";
        return text;
    }

    [[nodiscard]] std::string heading() const {
        std::string text;
        if (!panel_.title.empty()) text += lines_of(visible_text(panel_.title));
        return text + lines_of(visible_text(axis_text(panel_.y)));
    }

    // The x axis' label, then the meaning of the characters and the letters.
    [[nodiscard]] std::string below() const {
        const std::string label =
            cut_to(visible_text(axis_text(panel_.x)), static_cast<std::size_t>(columns_) - 4);
        const std::size_t width = text_width(label), room = static_cast<std::size_t>(columns_) - 4;
        std::string text = std::string(width < room ? room - width : 0, ' ') + label + "\n";
        if (panel_.map) {
            const HeatMap& map = *panel_.map;
            text += lines_of(fmt::format("{}: '.' from {:.3g}, '@' at {:.3g}",
                                         visible_text(axis_text({map.label, map.unit})),
                                         value_at({map.lowest, map.highest}, map.scale,
                                                  1.0 / static_cast<double>(level_characters.size())),
                                         map.highest));
        }
        for (std::size_t i = 0; i < panel_.curves.size(); ++i) {
            if (panel_.curves[i].name.empty()) continue;
            text += lines_of(fmt::format("  {} {}", curve_characters[i % curve_characters.size()],
                                         visible_text(panel_.curves[i].name)));
        }
        for (std::size_t i = 0; i < named_.size(); ++i)
            text += lines_of(fmt::format("  {} {}", letters[i], visible_text(named_[i]->name)));
        return text;
    }

    const Panel& panel_;
    int columns_;
    PlotRange x_, y_;
    GnuplotScript script_;
    std::vector<const NamedLine*> named_;
};

}  // namespace

std::optional<std::string> draw_text(const Figure& figure, int columns) {
    check_figure(figure);
    const int width = std::clamp(columns, 40, 200);
    std::string text;
    for (const std::string* words : {&figure.title, &figure.sentence}) {
        if (words->empty()) continue;
        for (const std::string& line : wrapped(visible_text(*words), static_cast<std::size_t>(width)))
            text += line + "\n";
    }
    for (const Panel& panel : figure.panels) {
        const auto drawn = TextPanel(panel, width).draw();
        if (!drawn) return std::nullopt;
        text += "\n" + *drawn;
    }
    return text;
}

}  // namespace ripplenotch
