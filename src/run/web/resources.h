#pragma once
// What every page has, from the files of this folder and from three.js, put into the program by CMake.
namespace frana {

struct PageResources {
    const char* frame;   ///< page.html: {{NAME}} stands for what differs
    const char* style;   ///< page.css
    const char* script;  ///< the .js files, one after the other
    const char* three;   ///< three.js and its parts; empty where CMake found none
};

const PageResources& page_resources();

}  // namespace frana
