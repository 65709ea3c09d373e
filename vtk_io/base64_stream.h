#pragma once
// A VTK writer spends most of its time in its own base64, of four letters a call. Includes VTK, so only for .cpp files
// of this room.
#include <vtkNew.h>
#include <vtkOutputStream.h>

#include <array>
#include <string>

namespace frana {

/// The letters of vtkBase64OutputStream, which go into the stream a block at a time.
class Base64Stream : public vtkOutputStream {
public:
    vtkTypeMacro(Base64Stream, vtkOutputStream);
    static Base64Stream* New();
    int StartWriting() override;
    int Write(const void* data, std::size_t length) override;
    int EndWriting() override;

private:
    std::array<unsigned char, 3> rest_{};  ///< of the last call, which made no whole three
    std::size_t resting_ = 0;
    std::string letters_;  ///< of one call
};

/// A VTK writer of XML with such a stream in place of VTK's.
template <class Writer>
class WithBase64Stream : public Writer {
public:
    static WithBase64Stream* New() {  // NOLINT(readability-identifier-naming): as VTK calls it
        auto* const made = new WithBase64Stream;
        made->InitializeObjectBase();
        return made;
    }

protected:
    WithBase64Stream() { this->SetDataStream(vtkNew<Base64Stream>()); }
};

}  // namespace frana
