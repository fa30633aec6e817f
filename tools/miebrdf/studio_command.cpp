// miebrdf studio: the page of `miebrdf report` with the words of its scene beside it, solved anew
// after each change.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

#include <miebrdf/database.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include "materials/database/user_file.h"
#include "pipeline/io/atomic_file.h"
#include "pipeline/io/plugin.h"
#include "pipeline/io/program_file.h"
#include "pipeline/report/page.h"
#include "pipeline/report/report_data.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/size_lattice.h"
#include "rte/stack/kept_layers.h"
#include "tools/miebrdf/program.h"
#include "tools/miebrdf/result_facts.h"
#include "tools/miebrdf/run_command.h"
#include "tools/miebrdf/scratch_folder.h"
#include "tools/miebrdf/studio_page.h"
#include "tools/miebrdf/studio_server.h"

extern char** environ;

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostRequestBytes = 16 << 20;
/// Where the scene has no tolerance of its own: of what is shown, and while something is dragged.
/// Files, command line, TOML and Python have the program's.
constexpr double kPictureTolerance = 1e-2, kPreviewTolerance = 3e-2;
/// What earlier changes left is seldom wanted again.
constexpr std::size_t kMemory = std::size_t{256} << 20, kLeastMemory = std::size_t{64} << 20;
constexpr std::chrono::seconds kMostSolving{120}, kMostWriting{300};
constexpr std::size_t kMostMaterials = 40;
constexpr char kFirstScene[] = R"({"base": ["TiO2,radius=0.2"], "coat": ["Au,radius=0.03@0.5"],
    "roughness": ["0.3"], "wavelengths": ["400:700:20"]})";

struct StudioArguments {
    std::string file;
    int port = 0;
    bool no_open = false;
};

std::string read_file(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// 128 random bits.
std::string new_token() {
    std::random_device random;
    std::string token;
    for (int k = 0; k < 4; ++k) token += fmt::format("{:08x}", random());
    return token;
}

/// In a time that does not depend on where they differ.
bool is_same(const std::string& a, const std::string& b) {
    unsigned different = a.size() == b.size() ? 0 : 1;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
        different |= unsigned(static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(b[k]));
    return different == 0;
}

/// This program with other words, in a folder of its own: what it cannot do harms no server.
/// @return  what it says on standard error
std::string run_aside(std::vector<std::string> words, const fs::path& folder,
                      const std::function<bool()>& is_cancelled) {
    words.insert(words.begin(), "miebrdf");
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string error = folder / "stderr";
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, 2, error.c_str(), O_WRONLY | O_CREAT, 0600);
    pid_t child = 0;
    const int failed =
        ::posix_spawn(&child, program_file().c_str(), &files, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    if (failed != 0) throw InputError("this program cannot be started a second time");
    const auto end = Clock::now() + kMostWriting;
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (is_cancelled() || Clock::now() > end) ::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return read_file(error);
}

class Studio {
  public:
    Studio(const Shell& shell, const StudioArguments& arguments)
        : shell_(shell), token_(new_token()) {
        restore(arguments.file);
    }

    void set_port(int port) { port_ = port; }
    std::string address() const {
        return fmt::format("http://127.0.0.1:{}/?token={}", port_, token_);
    }
    const fs::path& state() const { return state_; }

    HttpReply answer(const HttpRequest& request) {
        if (!is_ours(request))
            return refused(403, "this address is for the page that miebrdf studio has opened");
        try {
            if (request.method == "GET" && request.path == "/") return page();
            if (request.method == "POST") {
                const json asked = request.body.empty() ? json::object()
                                                        : json::parse(request.body, nullptr, false);
                if (!asked.is_object()) return refused(400, "a request is an object in JSON");
                for (const auto& [path, does] : kPaths)
                    if (request.path == path) return (this->*does)(asked);
            }
            return refused(404, "there is nothing of this name");
        } catch (const Cancelled&) {
            return refused(409, "a later change came");
        } catch (const Error& error) {
            return refused(422, message_of(error), error.field());
        } catch (const json::exception&) {
            return refused(400, "a key of the request is missing, or of another kind");
        } catch (const std::exception& error) {
            return refused(500, error.what());
        }
    }

  private:
    using Does = HttpReply (Studio::*)(const json&);
    static const std::vector<std::pair<const char*, Does>> kPaths;

    /// Of this machine, from this page, by who has the token.
    bool is_ours(const HttpRequest& request) const {
        const std::string here = fmt::format("127.0.0.1:{}", port_),
                          local = fmt::format("localhost:{}", port_);
        if (request.host != here && request.host != local) return false;
        if (!request.origin.empty() && request.origin != "http://" + request.host) return false;
        const auto asked = request.query.find("token");
        return is_same(request.token, token_) ||
               (request.method == "GET" && asked != request.query.end() &&
                is_same(asked->second, token_));
    }

    /// Messages hold what a person wrote, in any encoding.
    static std::string text_of_json(const json& body) {
        return body.dump(-1, ' ', false, json::error_handler_t::replace);
    }
    static HttpReply refused(int status, const std::string& error, const std::string& field = "") {
        return {status, "application/json", text_of_json(json{{"error", error}, {"field", field}})};
    }
    static HttpReply reply(const json& body) {
        return {200, "application/json", text_of_json(body)};
    }

    HttpReply page() const {
        return {200, "text/html; charset=utf-8", report::make_studio_page(token_)};
    }

    /// The scene of the file, else the one that was left, else the first one.
    void restore(const std::string& file) {
        const fs::path path = file.empty() ? state_ : fs::path(file);
        words_ = json::parse(kFirstScene);
        std::error_code unknown;
        if (file.empty() && !fs::exists(path, unknown)) return;
        try {
            const SceneFileResult result = read_scene_results(path.string()).at(0);
            SaidWords said;
            for (std::size_t k = 0; k < result.words.size(); ++k)
                said[result.words[k]] = result.said[k];
            words_ = words_for_page(said);
            view_ = page_of_scene_file(read_file(path));
        } catch (const Error& error) {
            if (!file.empty()) throw;
            shell_.note(
                fmt::format("the scene of the last session cannot be read: {}", error.what()));
        }
    }

    HttpReply get_state(const json& /*asked*/) {
        const std::lock_guard lock(mutex_);
        const json view = json::parse(view_, nullptr, false);
        return reply({{"words", words_},
                      {"view", view.is_discarded() ? json() : view},
                      {"formats", format_names()}});
    }

    /// A scene file after each change: a page that is closed loses nothing.
    HttpReply put_state(const json& asked) {
        const SaidWords said = words_from_page(asked.at("words"));
        const std::lock_guard lock(mutex_);
        words_ = words_for_page(said);
        view_ = asked.value("view", json::object()).dump();
        fs::create_directories(state_.parent_path());
        AtomicFile file(state_);
        file.stream() << scene_file_of(said, view_);
        file.commit();
        return reply({{"saved", state_.string()}});
    }

    HttpReply texts(const json& asked) {
        const SaidWords said = words_from_page(asked.at("words"));
        std::vector<std::string> command = arguments_of(said);
        command.insert(command.begin(), "report");
        command.insert(command.end(), {"-o", "scene.html"});
        return reply({{"command", command_line_of(command)},
                      {"toml", scene_file_of(said, "")},
                      {"python", python_of(said)}});
    }

    HttpReply materials(const json& asked) {
        const auto database = materials::Database::layered(materials::default_user_database());
        json found = json::array();
        for (const auto& material : database.search(asked.at("text").get<std::string>())) {
            if (found.size() == kMostMaterials) break;
            found.push_back({{"name", material.name},
                             {"title", material.title},
                             {"from_nm", material.shortest_nm},
                             {"to_nm", material.longest_nm},
                             {"k_known", material.k_known}});
        }
        return reply({{"materials", found}});
    }

    /// Colours of materials, each computed once.
    HttpReply chips(const json& asked) {
        const auto names = asked.at("names").get<std::vector<std::string>>();
        if (names.size() > kMostMaterials)
            throw UsageError("names", double(names.size()), "at most 40 materials at once");
        return reply({{"chips", chips_.of(names, bare_control())}});
    }

    /// A page's words as its pictures are solved.
    static Request picture_of(const SaidWords& said, bool is_preview) {
        Request request = request_of_page(said);
        if (said.count("tolerance") == 0) request.solver.tolerance = kPictureTolerance;
        if (is_preview) {
            request.solver.tolerance = std::max(request.solver.tolerance, kPreviewTolerance);
            request.solver.stokes = 1;
        }
        return request;
    }

    /// Of one tab the last request alone is solved.
    HttpReply solve(const json& asked) {
        const SaidWords said = words_from_page(asked.at("words"));
        const bool is_preview = asked.value("preview", false);
        const Request request = picture_of(said, is_preview);
        return in_turn(asked, [&](Control control) {
            control.memo = memo_for(request, is_preview);
            return solved_page(said, request, is_preview, control);
        });
    }

    HttpReply drawdown(const json& asked) {
        const bool is_preview = asked.value("preview", false);
        const Request request = picture_of(words_from_page(asked.at("words")), is_preview);
        const Viewing light = viewing(asked.value("light", std::string("d65")));
        return in_turn(asked, [&](Control control) {
            control.memo = memo_for(request, is_preview);
            return reply(drawdown_for_page(request, light, is_preview, control));
        });
    }

    HttpReply solved_page(const SaidWords& said, const Request& request, bool is_preview,
                          const Control& control) const {
        const auto start = Clock::now();
        std::vector<std::string> command = arguments_of(said);
        command.insert(command.begin(), "report");
        report::ReportScene scene{report::label_of(request.scene), describe(request.scene)};
        scene.variants.push_back(
            {solved(request, control), "", 0.0, [&](const ResultReport& result) {
                 return page_facts(request.scene, result, command_line_of(command));
             }});
        const report::ReportData data = report::collect(
            {scene}, control, is_preview ? report::PageDetail::preview : report::PageDetail::whole);
        const std::chrono::duration<double> seconds = Clock::now() - start;
        return reply({{"data", data.bytes.compressed(data.root, 1)},
                      {"preview", is_preview},
                      {"shortfalls", data.shortfalls},
                      {"seconds", seconds.count()}});
    }

    /// What solutions of this kind have left, as all of them are asked one after the other. Spheres
    /// of previews are interpolated between sizes that are kept.
    std::shared_ptr<OpticsMemo> memo_for(const Request& request, bool is_preview) {
        std::shared_ptr<OpticsMemo>& memo = is_preview ? preview_memo_ : memo_;
        if (memo == nullptr || memo->free_bytes() < kLeastMemory) {
            memo = make_optics_memo(kMemory);
            memo->kept_layers = std::make_shared<rte::KeptLayers>();
        }
        const double tolerance = request.scene.particles.tolerance;
        memo->whole_tolerance = demand_of(request.solver, tolerance, PhaseDemand::whole).tolerance;
        if (is_preview)
            memo->lattice = std::make_shared<const SizeLattice>(
                SizeLattice::kCoarseStep, std::vector<mie::SizeDistribution>{}, false, nullptr);
        return memo;
    }

    HttpReply measured(const json& asked) { return reply(measured_for_page(asked)); }

    HttpReply fit(const json& asked) {
        const SaidWords said = words_from_page(asked.at("words"));
        return in_turn(asked, [&](const Control& control) {
            return reply(fit_for_page(said, asked, control));
        });
    }

    /// One at a time, which ends when a later request of the same tab comes, or after two minutes.
    /// @throws Cancelled   for the first
    /// @throws InputError  for the second
    template <typename Does>
    HttpReply in_turn(const json& asked, Does does) {
        const std::string tab = asked.value("tab", std::string()).substr(0, 40);
        const int number = newest(tab);
        const std::lock_guard one(solving_);
        const auto end = Clock::now() + kMostSolving;
        Control control = bare_control();
        control.is_cancelled = [=, this, is_stopped = control.is_cancelled] {
            return is_stopped() || is_stale(tab, number) || Clock::now() > end;
        };
        if (control.is_cancelled()) throw Cancelled();
        try {
            return does(control);
        } catch (const Cancelled&) {
            if (Clock::now() <= end) throw;
            throw InputError(
                fmt::format("not solved within {} s; fewer wavelengths or a larger tolerance take "
                            "less, `miebrdf run` takes as long as it needs",
                            kMostSolving.count()));
        }
    }

    /// Without progress, and without the cache: a hundred results of each change, seldom wanted
    /// again.
    Control bare_control() const {
        Control control = shell_.control();
        control.progress = {};
        control.job_begun = {};
        control.piece_done = {};
        control.cache = {};
        return control;
    }

    static std::vector<std::string> format_names() {
        std::vector<std::string> names;
        for (const Format& format : all_formats()) names.push_back(format.name);
        return names;
    }

    int newest(const std::string& tab) {
        const std::lock_guard lock(mutex_);
        if (tabs_.size() > 100) tabs_.clear();
        return ++tabs_[tab];
    }
    bool is_stale(const std::string& tab, int number) {
        const std::lock_guard lock(mutex_);
        return tabs_[tab] != number;
    }

    /// A file by the command that writes such files.
    HttpReply write(const json& asked) {
        const SaidWords said = words_from_page(asked.at("words"));
        request_of_page(said);
        const auto kind = asked.at("kind").get<std::string>();
        const ScratchFolder folder;
        std::vector<std::string> words;
        std::string name;
        if (kind == "albedo" || kind == "report") {
            name = kind == "albedo" ? "albedo.csv" : "report.html";
            words = {kind};
        } else {
            name = "scene" + find_format(kind).endings.front();
            words = {"export", "--format", kind};
        }
        for (const std::string& word : arguments_of(said)) words.push_back(word);
        words.insert(words.end(), {"-o", folder.path() / name, "--quiet"});
        const std::lock_guard one(solving_);
        const std::string said_why = run_aside(
            words, folder.path(), [stop = shell_.control().is_cancelled] { return stop(); });
        std::vector<fs::path> written;
        for (const auto& entry : fs::directory_iterator(folder.path())) {
            if (entry.path().filename() != "stderr") written.push_back(entry.path());
        }
        if (written.empty()) {
            throw InputError(said_why.empty() ? fmt::format("{} took too long", kind)
                                              : said_why.substr(0, 2000));
        }
        std::sort(written.begin(), written.end());
        // Formats that write one file for spectra and one for colours: the spectra.
        const fs::path file = written.back();
        return {200, "application/octet-stream", read_file(file), file.filename()};
    }

    const Shell& shell_;
    std::shared_ptr<OpticsMemo> memo_, preview_memo_;  ///< used with solving_ locked
    fs::path state_ = materials::user_file("XDG_STATE_HOME", ".local/state", "studio.toml");
    std::string token_;
    int port_ = 0;
    std::mutex mutex_;  ///< of the next three
    json words_;
    std::string view_;
    std::map<std::string, int> tabs_;
    MaterialChips chips_;
    std::mutex solving_;  ///< one scene at a time, on all processors
};

const std::vector<std::pair<const char*, Studio::Does>> Studio::kPaths = {
    {"/api/state", &Studio::get_state},   {"/api/save", &Studio::put_state},
    {"/api/texts", &Studio::texts},       {"/api/materials", &Studio::materials},
    {"/api/solve", &Studio::solve},       {"/api/write", &Studio::write},
    {"/api/measured", &Studio::measured}, {"/api/fit", &Studio::fit},
    {"/api/drawdown", &Studio::drawdown}, {"/api/chips", &Studio::chips}};

/// By the desktop's own choice; where there is none, the address is on the terminal.
void open_in_browser(const std::string& address) {
    std::string program = "xdg-open", where = address;
    char* arguments[] = {program.data(), where.data(), nullptr};
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    for (const int stream : {1, 2})
        ::posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    ::posix_spawnp(&child, program.c_str(), &files, nullptr, arguments, environ);
    ::posix_spawn_file_actions_destroy(&files);
}

int run_studio(const StudioArguments& arguments, const Shell& shell) {
    if (arguments.port < 0 || arguments.port > 65535)
        throw UsageError("port", arguments.port, "0 (one that is free) to 65535");
    Serve* const serve = plugin_function<Serve>("studio", "miebrdf_serve", "libcpp-httplib-dev");
    Studio studio(shell, arguments);
    (*serve)({.port = arguments.port,
              .most_bytes = kMostRequestBytes,
              .answer = [&](const HttpRequest& request) { return studio.answer(request); },
              .listening =
                  [&](int port) {
                      studio.set_port(port);
                      fmt::print("{}\n", studio.address());
                      std::fflush(stdout);
                      shell.note(fmt::format("the scene is kept in {}; Ctrl-C ends the studio",
                                             studio.state().string()));
                      if (!arguments.no_open) open_in_browser(studio.address());
                  },
              .is_ended = shell.control().is_cancelled});
    return kGood;
}

}  // namespace

void add_studio(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<StudioArguments>();
    option(command, "scene", arguments->file, "SCENE.toml",
           "scene file to begin with (its first result); default: the scene of the last session");
    option(command, "--port", arguments->port, "N",
           "port of 127.0.0.1 for the page; 0: any free one");
    command.add_flag("--no-open", arguments->no_open,
                     "print the address of the page, but open no browser");
    finish(command, shell, arguments, run_studio,
           "Example:\n  miebrdf studio\n  miebrdf studio paint.toml --no-open --port 8080",
           Writes::table);
}

}  // namespace miebrdf::program
