#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rayuela {

/// A modal to choose a file, drawn with ImGui alone, so that it works in the window and off-screen. One at a time.
class FileDialog {
public:
    struct Request {
        std::string title = {};       ///< "Open scene".
        std::string action = "Open";  ///< The button's text.
        /// Lower case with the dot, ".scene.json"; the first is added to a typed name.
        std::vector<std::string> extensions = {};
        std::string name = {};  ///< Proposed file name.
        bool save = false;      ///< A new name may be typed; an existing file asks before it is overwritten.
        std::function<void(const std::filesystem::path&)> chosen = {};
    };

    /// A folder that is offered beside the list.
    struct Place {
        std::string name;
        std::filesystem::path folder;
    };

    /// Starts in `folder`, or where the last one was left if that is empty.
    void open(Request request, const std::filesystem::path& folder = {});
    bool is_open() const { return open_; }
    /// Once a frame.
    void draw(const std::vector<Place>& places);

private:
    struct Item {
        std::filesystem::path path;
        std::string name;
        std::string detail;
        bool folder = false;
    };

    void enter(std::filesystem::path folder);
    void draw_path();
    void draw_places(const std::vector<Place>& places);
    void draw_items();
    void draw_footer();
    void accept();
    void close();
    std::filesystem::path typed_path() const;
    bool matches(const std::filesystem::path& file) const;

    Request request_;
    std::filesystem::path folder_;
    std::vector<Item> items_;
    std::string name_;
    std::string error_;
    std::string filter_;
    bool open_ = false;
    bool opening_ = false;
    bool show_hidden_ = false;
    bool ask_overwrite_ = false;
};

}  // namespace rayuela
