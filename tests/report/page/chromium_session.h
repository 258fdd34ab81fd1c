#pragma once

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace grainfield::report {

/// Chromium without a window, steered over the pipe of its DevTools protocol: a screen of any size,
/// real keys, real time.
class ChromiumSession {
 public:
    using json = nlohmann::json;

    /// Whether one is installed.
    static bool is_installed() { return !program().empty(); }

    /// `profile`: a folder for what the browser keeps.
    explicit ChromiumSession(const std::filesystem::path& profile) {
        int to_child[2];
        int from_child[2];
        if (pipe2(to_child, O_CLOEXEC) != 0 || pipe2(from_child, O_CLOEXEC) != 0) {
            throw std::runtime_error("no pipe");
        }
        const std::string name = program();
        const std::string user_data = "--user-data-dir=" + profile.string();
        child_ = fork();
        if (child_ == 0) {
            // The protocol has descriptors 3 and 4; neither may be one of ours on the way there.
            const int in = fcntl(to_child[0], F_DUPFD, 10);
            const int out = fcntl(from_child[1], F_DUPFD, 10);
            dup2(in, 3);
            dup2(out, 4);
            const int nothing = open("/dev/null", O_RDWR);
            for (int stream = 0; stream < 3; ++stream) dup2(nothing, stream);
            execlp(name.c_str(), name.c_str(), "--headless", "--remote-debugging-pipe",
                   "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                   "--disable-background-networking", "--disable-component-update",
                   "--disable-sync", "--hide-scrollbars", user_data.c_str(), "about:blank",
                   static_cast<char*>(nullptr));
            _exit(127);
        }
        close(to_child[0]);
        close(from_child[1]);
        write_ = to_child[1];
        read_ = from_child[0];
        const json target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
        session_ =
            call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
        call("Page.enable");
    }
    ChromiumSession(const ChromiumSession&) = delete;
    ChromiumSession& operator=(const ChromiumSession&) = delete;
    ~ChromiumSession() {
        close(write_);
        close(read_);
        kill(child_, SIGTERM);
        waitpid(child_, nullptr, 0);
    }

    /// Opens a page on a screen of this many CSS pixels and waits until all is drawn.
    void open_page(const std::filesystem::path& file, int width, int height) {
        resize(width, height);
        call("Page.navigate", {{"url", "about:blank"}});
        call("Page.navigate", {{"url", "file://" + file.string()}});
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
        while (evaluate("document.documentElement?.dataset.ready ?? ''") == "") {
            if (std::chrono::steady_clock::now() > end) throw std::runtime_error("never drawn");
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    }

    /// From now on the screen has this many CSS pixels.
    void resize(int width, int height) {
        call("Emulation.setDeviceMetricsOverride", {{"width", width},
                                                    {"height", height},
                                                    {"deviceScaleFactor", 1},
                                                    {"mobile", width < 600}});
    }

    /// The value of an expression of JavaScript; that of a promise once it is kept.
    json evaluate(const std::string& expression) {
        const json answer =
            call("Runtime.evaluate",
                 {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
        if (answer.contains("exceptionDetails")) throw std::runtime_error(answer.dump());
        return answer["result"].value("value", json());
    }

    /// The left button pressed at one place of the screen and released at another [CSS pixels].
    void drag(double from_x, double from_y, double to_x, double to_y) {
        const auto mouse = [&](const char* type, double x, double y, int buttons) {
            call("Input.dispatchMouseEvent", {{"type", type},
                                              {"x", x},
                                              {"y", y},
                                              {"button", "left"},
                                              {"buttons", buttons},
                                              {"clickCount", 1}});
        };
        mouse("mousePressed", from_x, from_y, 1);
        if (from_x != to_x || from_y != to_y) mouse("mouseMoved", to_x, to_y, 1);
        mouse("mouseReleased", to_x, to_y, 0);
    }

    /// A key as of a keyboard: "Tab", "Enter", "ArrowRight", " ".
    void press(const std::string& key, bool shift = false) {
        int code = key == "Tab" ? 9 : key == "Enter" ? 13 : key == " " ? 32 : 0;
        if (key == "ArrowLeft") code = 37;
        if (key == "ArrowRight") code = 39;
        json event{{"key", key}, {"windowsVirtualKeyCode", code}, {"modifiers", shift ? 8 : 0}};
        event["code"] = key == " " ? "Space" : key;
        event["type"] = "rawKeyDown";
        if (key == "Enter") event["text"] = "\r";
        if (key == " ") event["text"] = " ";
        if (event.contains("text")) event["type"] = "keyDown";
        call("Input.dispatchKeyEvent", event);
        event["type"] = "keyUp";
        event.erase("text");
        call("Input.dispatchKeyEvent", event);
    }

 private:
    static std::string program() {
        for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
            const std::string command = std::string("command -v ") + name + " >/dev/null";
            if (std::system(command.c_str()) == 0) return name;
        }
        return "";
    }

    json call(const std::string& method, const json& parameters = json::object()) {
        json message{{"id", ++last_}, {"method", method}, {"params", parameters}};
        if (!session_.empty()) message["sessionId"] = session_;
        const std::string text = message.dump() + '\0';
        for (std::size_t sent = 0; sent < text.size();) {
            const ssize_t n = write(write_, text.data() + sent, text.size() - sent);
            if (n <= 0) throw std::runtime_error("Chromium takes no more: " + method);
            sent += static_cast<std::size_t>(n);
        }
        for (;;) {
            const json answer = next();
            if (answer.value("id", 0) != last_) continue;
            if (answer.contains("error")) throw std::runtime_error(answer.dump());
            return answer["result"];
        }
    }

    json next() {
        for (;;) {
            if (const auto end = buffer_.find('\0'); end != std::string::npos) {
                json message = json::parse(buffer_.substr(0, end));
                buffer_.erase(0, end + 1);
                return message;
            }
            pollfd ready{read_, POLLIN, 0};
            if (poll(&ready, 1, 120'000) <= 0) throw std::runtime_error("Chromium is silent");
            std::vector<char> part(1 << 16);
            const ssize_t n = read(read_, part.data(), part.size());
            if (n <= 0) throw std::runtime_error("Chromium has ended");
            buffer_.append(part.data(), static_cast<std::size_t>(n));
        }
    }

    pid_t child_ = -1;
    int write_ = -1, read_ = -1, last_ = 0;
    std::string session_, buffer_;
};

}  // namespace grainfield::report
