// SPDX-License-Identifier: MIT
// Files read and written, and the names that they may have.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/process/two_cores.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using std::chrono::duration;

namespace fs = std::filesystem;

namespace {
struct Folder {
    fs::path path = fs::temp_directory_path() / ("ripplenotch-files-" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
    [[nodiscard]] std::string file(const char* name) const { return (path / name).string(); }
    [[nodiscard]] std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), {}));
    }
};
}  // namespace

TEST_CASE("a file appears under its name only when it is finished") {
    const Folder folder;
    {
        ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
        sink.write("half");
        CHECK_FALSE(fs::exists(folder.file("a")));
    }
    CHECK(folder.entries() == 0);
    write_all(folder.file("a"), "whole", ByteSink::Overwrite::no);
    CHECK(read_all(folder.file("a")) == "whole");
    CHECK(folder.entries() == 1);
}

TEST_CASE("nothing is overwritten unasked, not even what appears while writing") {
    const Folder folder;
    write_all(folder.file("a"), "old", ByteSink::Overwrite::no);
    CHECK_THROWS_WITH(write_all(folder.file("a"), "new", ByteSink::Overwrite::no), Contains("--force"));
    CHECK(read_all(folder.file("a")) == "old");
    write_all(folder.file("a"), "new", ByteSink::Overwrite::yes);
    CHECK(read_all(folder.file("a")) == "new");

    ByteSink sink(folder.file("b"), ByteSink::Overwrite::no);
    write_all(folder.file("b"), "someone else's", ByteSink::Overwrite::no);
    CHECK_THROWS_AS(sink.finish(), FileError);
    CHECK(read_all(folder.file("b")) == "someone else's");
    CHECK(folder.entries() == 2);
}

TEST_CASE("what is replaced keeps its rights") {
    const Folder folder;
    for (const auto rights : {0600, 0640, 0444, 0755}) {
        write_all(folder.file("a"), "old", ByteSink::Overwrite::yes);
        REQUIRE(::chmod(folder.file("a").c_str(), static_cast<mode_t>(rights)) == 0);
        write_all(folder.file("a"), "new", ByteSink::Overwrite::yes);
        CHECK(read_all(folder.file("a")) == "new");
        CHECK(static_cast<int>(fs::status(folder.file("a")).permissions()) == rights);
    }
}

TEST_CASE("a file that replaces a private one is private from its first byte on") {
    const Folder folder;
    write_all(folder.file("a"), "old", ByteSink::Overwrite::no);
    REQUIRE(::chmod(folder.file("a").c_str(), 0600) == 0);
    ByteSink sink(folder.file("a"), ByteSink::Overwrite::yes);
    sink.write("new");
    for (const auto& entry : fs::directory_iterator(folder.path))
        CHECK((entry.status().permissions() & fs::perms::others_all) == fs::perms::none);
}

TEST_CASE("a link stays, and the file behind it is replaced") {
    const Folder folder;
    fs::create_directory(folder.path / "there");
    write_all(folder.file("there/a"), "old", ByteSink::Overwrite::no);
    fs::create_symlink("there/a", folder.file("link"));
    CHECK_THROWS_WITH(write_all(folder.file("link"), "new", ByteSink::Overwrite::no), Contains("--force"));
    write_all(folder.file("link"), "new", ByteSink::Overwrite::yes);
    CHECK(fs::is_symlink(folder.file("link")));
    CHECK(read_all(folder.file("there/a")) == "new");
    CHECK(folder.entries() == 2);
}

TEST_CASE("a link to nothing is refused") {
    const Folder folder;
    fs::create_symlink("nowhere", folder.file("link"));
    for (const auto& overwrite : {ByteSink::Overwrite::no, ByteSink::Overwrite::yes})
        CHECK_THROWS_WITH(write_all(folder.file("link"), "new", overwrite), Contains("link"));
    CHECK(fs::is_symlink(folder.file("link")));
}

TEST_CASE("a file that changes while it is read is refused at its end") {
    const Folder folder;
    const std::string path = folder.file("log");
    const auto read_with = [&](auto change) {
        write_all(path, std::string(100000, 'x'), ByteSink::Overwrite::yes);
        ByteSource source(path);
        std::string bytes(40000, '\0');
        REQUIRE(source.read(bytes.data(), bytes.size()) == bytes.size());
        change();
        while (source.read(bytes.data(), bytes.size()) > 0) {
        }
    };
    CHECK_NOTHROW(read_with([] {}));
    CHECK_THROWS_WITH(read_with([&] { fs::resize_file(path, 60000); }),
                      Contains("changed while it was read") && Contains("100000 bytes") && Contains("60000"));
    CHECK_THROWS_WITH(read_with([&] { fs::resize_file(path, 10000); }), Contains("changed"));
    CHECK_THROWS_WITH(read_with([&] { std::ofstream(path, std::ios::app) << "more"; }), Contains("100004"));
    CHECK_THROWS_WITH(
        read_with([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));  // clocks of files are coarse
            std::fstream(path) << "other";
        }),
        Contains("something wrote to it"));
}

TEST_CASE("the hash is that of the bytes that were read") {
    const Folder folder;
    const std::string path = folder.file("log");
    write_all(path, "abc", ByteSink::Overwrite::no);
    watch_inputs(true);
    hash_inputs(true);
    CHECK(read_all(path) == "abc");
    write_all(path, "what came later", ByteSink::Overwrite::yes);
    CHECK(sha256_as_read(path) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK_THROWS_WITH(read_all(path), Contains("another than when it was read"));
    watch_inputs(false);
    CHECK(read_all(path) == "what came later");
}

TEST_CASE("a file that is read twice must be the same, though nobody hashes it and its times were set back") {
    const Folder folder;
    const std::string path = folder.file("log");
    write_all(path, "first bytes", ByteSink::Overwrite::no);
    watch_inputs(true);
    CHECK(read_all(path) == "first bytes");
    CHECK(read_all(path) == "first bytes");
    CHECK(sha256_as_read(path).empty());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // clocks of files are coarse
    const auto written = fs::last_write_time(path);
    std::fstream(path) << "other bytes";
    fs::last_write_time(path, written);
    CHECK_THROWS_WITH(read_all(path), Contains("another than when it was read"));
    watch_inputs(false);
    CHECK(read_all(path) == "other bytes");
}

TEST_CASE("who reads half of a file notices no less") {
    const Folder folder;
    const std::string path = folder.file("log");
    write_all(path, std::string(1000, 'x'), ByteSink::Overwrite::no);
    watch_inputs(true);
    std::string some(10, '\0');
    CHECK(ByteSource(path).read(some.data(), some.size()) == some.size());
    fs::resize_file(path, 500);
    CHECK_THROWS_WITH(read_all(path), Contains("another than when it was read"));
    watch_inputs(false);
}

TEST_CASE("a second pass reads the same file, whatever has its name by then") {
    const Folder folder;
    write_all(folder.file("log"), "first", ByteSink::Overwrite::no);
    const Spool spool(folder.file("log"));
    write_all(folder.file("log"), "second", ByteSink::Overwrite::yes);
    std::string bytes(10, '\0');
    CHECK(spool.open()->read(bytes.data(), bytes.size()) == 5);
    CHECK(bytes.substr(0, 5) == "first");
}

TEST_CASE("what a pipe said waits in a file that nobody sees") {
    const Folder folder;
    REQUIRE(::mkfifo(folder.file("pipe").c_str(), 0600) == 0);
    fs::create_directory(folder.path / "tmp");
    const std::string before = std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "";
    ::setenv("TMPDIR", folder.file("tmp").c_str(), 1);
    std::thread writer([&] { std::ofstream(folder.file("pipe")) << "from a pipe"; });
    const Spool spool(folder.file("pipe"));
    writer.join();
    CHECK(fs::is_empty(folder.path / "tmp"));
    for (int pass = 0; pass < 2; ++pass) {
        std::string bytes(20, '\0');
        CHECK(spool.open()->read(bytes.data(), bytes.size()) == 11);
        CHECK(bytes.substr(0, 11) == "from a pipe");
    }
    before.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before.c_str(), 1);
}

TEST_CASE("bytes that are held are read as the file of their name, as long as they are held") {
    const Folder folder;
    const std::string path = folder.file("log");
    write_all(path, "of the file", ByteSink::Overwrite::no);
    watch_inputs(true);
    hash_inputs(true);
    CHECK(read_all(path) == "of the file");
    for (const std::string& bytes : {std::string("abc"), std::string("what came later"), std::string()}) {
        const HeldFile held(path, bytes);
        CHECK(read_all(path) == bytes);
        CHECK(read_all(path) == bytes);
        CHECK(Spool(path).open()->by_place());
        if (bytes == "abc")
            CHECK(sha256_as_read(path) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
    CHECK(read_all(path) == "of the file");
    watch_inputs(false);
}

TEST_CASE("bytes of an unfinished file can be rewritten") {
    const Folder folder;
    ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
    sink.write("0000 rows");
    REQUIRE(sink.can_rewrite());
    sink.rewrite(0, "1234");
    sink.finish();
    CHECK(read_all(folder.file("a")) == "1234 rows");
}

TEST_CASE("pieces of any size follow one another in a file, rewritten or not") {
    const Folder folder;
    std::mt19937_64 random(3);
    std::string all;
    ByteSink sink(folder.file("a"), ByteSink::Overwrite::no);
    sink.expect(1 << 20);
    for (int i = 0; i < 60; ++i) {
        const std::size_t sizes[] = {0, 1, 4095, 65535, 65536, 65537, 131072, random() % 300000};
        const std::string piece(sizes[random() % 8], static_cast<char>('a' + i % 26));
        sink.write(piece);
        all += piece;
        if (i % 20 != 10) continue;
        sink.rewrite(all.size() / 2, "HERE");
        all.replace(all.size() / 2, 4, "HERE");
    }
    sink.finish();
    CHECK(read_all(folder.file("a")) == all);
}

TEST_CASE("room that was reserved and not needed is given back") {
    const Folder folder;
    for (const std::uint64_t expected : {std::uint64_t{0}, std::uint64_t{64} << 20}) {
        const std::string path = folder.file(expected == 0 ? "plain" : "reserved");
        ByteSink sink(path, ByteSink::Overwrite::no);
        sink.expect(expected);
        sink.write(std::string(100000, 'x'));
        sink.finish();
        struct stat status {};
        REQUIRE(::stat(path.c_str(), &status) == 0);
        CHECK(status.st_size == 100000);
        CHECK(status.st_blocks * 512 < 1000000);
    }
}

TEST_CASE("a missing file and a folder are named with the reason") {
    const Folder folder;
    CHECK_THROWS_WITH(read_all(folder.file("none")), Contains("none") && Contains("No such file"));
    CHECK_THROWS_WITH(read_all(folder.path.string()), Contains("is a directory"));
}

TEST_CASE("SHA-256 agrees with the standard's own examples") {
    // FIPS 180-2, appendix B.1 and the empty message.
    Sha256 abc;
    abc.update("a");
    abc.update("bc");
    CHECK(abc.hex() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(Sha256().hex() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_CASE("a name that promises another kind of file is refused with those that fit") {
    for (const char* name : {"x.csv", "a.b/x.CSV", "x.json.csv", ".hidden.csv"}) {
        CHECK_THROWS_AS(check_output_name(name, "a track", ".txt .json"), UsageError);
        CHECK_NOTHROW(check_output_name(name, "a track", ".json .csv"));
    }
    CHECK_THROWS_WITH(check_output_name("x.svg", "a track", ".csv .npy .json"),
                      Contains("-o x.svg: a track is not written as a picture; name it .csv, .npy or .json"));
    CHECK_THROWS_WITH(check_output_name("x.json", "a log", ".csv .npy"),
                      Contains("as JSON; name it .csv or .npy"));
    CHECK_THROWS_WITH(check_output_name("x.txt", "a report", ".html"), Contains("as text; name it .html"));
}

TEST_CASE("names that promise nothing are free") {
    for (const char* name : {"-", "", "x", "run.log", "x.dat", "a.csv/x", ".csv", "/dev/null", "x.2", "x."})
        CHECK_NOTHROW(check_output_name(name, "a track", ".json"));
}

TEST_CASE("an ending fits as a whole only") {
    CHECK_THROWS_AS(check_output_name("x.h", "a page", ".html .htm"), UsageError);
    CHECK_THROWS_AS(check_output_name("x.htm", "a page", ".html"), UsageError);
    CHECK_NOTHROW(check_output_name("x.h", "a header", ".html .h"));
    CHECK_NOTHROW(check_output_name("x.h", "a header", ".h .hpp"));
}

// What is told while work goes on, and work on two cores.

TEST_CASE("progress shows share, rate and the time that is left") {
    const Progress::State state{"reading", "B", 45'000'000, 100'000'000, 1};
    CHECK(progress_line("filter", state, duration<double>(3.0), 79) ==
          "filter: reading [=============>                ]   45 %  15.0 MB/s  4 s left");
}

TEST_CASE("without a total it shows rate and the time spent") {
    CHECK(progress_line("filter", {"reading", "B", 1500, 0, 1}, duration<double>(2.0), 79) ==
          "filter: reading  750 B/s  2 s");
    CHECK(progress_line("identify", {"looking for lines", "", 0, 0, 1}, duration<double>(200.0), 79) ==
          "identify: looking for lines  3:20 min");
}

TEST_CASE("the bar is empty at first, full at the end, and never beyond") {
    const auto line = [](std::uint64_t done) {
        return progress_line("x", {"y", "rows", done, 1000, 1}, duration<double>(1.0), 60);
    };
    CHECK(line(0).find("[>      ") != std::string::npos);
    CHECK(line(0).find("left") == std::string::npos);
    CHECK(line(1000).find('>') == std::string::npos);
    CHECK(line(1000).find("100 %") != std::string::npos);
    CHECK(line(5000).find("100 %") != std::string::npos);
    CHECK(line(999).find(" 99 %") != std::string::npos);
}

TEST_CASE("the line fits the terminal, however narrow") {
    for (int columns = 1; columns <= 200; ++columns) {
        for (const std::uint64_t done : {0ULL, 1ULL, 123'456'789ULL, 10'000'000'000ULL}) {
            for (const std::uint64_t total : {0ULL, 10'000'000'000ULL}) {
                const Progress::State state{"reading", "B", done, total, 1};
                CHECK(progress_line("filter", state, duration<double>(5000.0), columns).size() <=
                      static_cast<std::size_t>(columns));
            }
        }
    }
}

TEST_CASE("a stage that begins starts from nothing") {
    Progress progress;
    progress.begin("reading", "B", 100);
    progress.add(60);
    progress.add(10);
    CHECK(progress.state().done == 70);
    progress.begin("looking", "joints", 3);
    CHECK(progress.state().done == 0);
    CHECK(progress.state().total == 3);
    CHECK(progress.state().stage == 2);
}

TEST_CASE("nothing steps aside where nothing is shown") {
    Progress progress;
    progress.step_aside();
    static int asked;
    asked = 0;
    progress.on_step_aside([] { ++asked; });
    progress.step_aside();
    CHECK(asked == 1);
}

namespace {

// How many threads had a part in the work, which waits a while for another.
std::size_t threads_of(std::size_t count, bool worth_it = true) {
    std::mutex mutex;
    std::set<std::thread::id> threads;
    on_two_cores(
        count,
        [&](std::size_t) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            const std::lock_guard lock(mutex);
            threads.insert(std::this_thread::get_id());
        },
        worth_it);
    return threads.size();
}

}  // namespace

TEST_CASE("every part of the work is done once, on however many cores") {
    for (const bool worth_it : {false, true}) {
        std::vector<int> done(1000);
        on_two_cores(
            done.size(), [&](std::size_t i) { ++done[i]; }, worth_it);
        CHECK(done == std::vector<int>(1000, 1));
    }
}

TEST_CASE("work stays on one core where a thread costs more") {
    CHECK(threads_of(1) == 1);
    CHECK(threads_of(40, false) == 1);
    if (cores_here() > 1) CHECK(threads_of(40) == 2);
}

TEST_CASE("what a part throws is thrown, and no part begins after it") {
    CHECK_THROWS_AS(on_two_cores(10,
                                 [](std::size_t i) {
                                     if (i == 3) throw std::runtime_error("no");
                                 }),
                    std::runtime_error);
    int done = 0;
    const auto work = [&](std::size_t i) {
        if (i == 3) throw std::runtime_error("no");
        ++done;
    };
    CHECK_THROWS(on_two_cores(10, work, false));
    CHECK(done == 3);
}
