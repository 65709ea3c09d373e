#include "io/hdf5_packing.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <numeric>

#include "base/on_threads.h"

namespace frana::hdf5 {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays go into the file as they lie in memory");

constexpr hsize_t kChunk = hsize_t{1} << 18;                               // bytes
constexpr std::size_t kLeftOut = std::numeric_limits<std::size_t>::max();  // of a chunk of zeros
constexpr int kLevel = 1;  // the higher ones take twice the time for a tenth of the bytes

/// Memory that is not set before it is written.
class Bytes {
public:
    explicit Bytes(std::size_t count) : bytes_(new unsigned char[count]) {}
    unsigned char* data() { return bytes_.get(); }

private:
    std::unique_ptr<unsigned char[]> bytes_;
};

/// The first bytes of all numbers, then the second ones, and so on. In stretches that stay in the fastest cache.
template <std::size_t width>
void shuffle(const unsigned char* from, std::size_t numbers, unsigned char* to) {
    constexpr std::size_t kStretch = 512;
    for (std::size_t first = 0; first < numbers; first += kStretch) {
        const std::size_t count = std::min(kStretch, numbers - first);
        for (std::size_t k = 0; k < width; ++k)
            for (std::size_t n = 0; n < count; ++n) to[k * numbers + first + n] = from[(first + n) * width + k];
    }
}

/// Makes one chunk at a time. The lowest bytes of measured numbers are noise. A compressor spends most of its time there
/// and finds nothing. So they are copied as "stored" blocks (RFC 1951), and only the bytes above them are compressed.
class Packer {
public:
    Packer(std::size_t bytes, std::size_t width)
        : bytes_(bytes), width_(width), shuffled_(bytes), compressor_(libdeflate_alloc_compressor(kLevel)) {
        expect(width == 1 || width == 4 || width == 8, "numbers of a file have one, four or eight bytes");
        if (!compressor_) throw std::bad_alloc();
    }

    /// The most that a chunk becomes.
    std::size_t bound() const {
        return 6 + 5 * (bytes_ / kMostStored + 1) + libdeflate_deflate_compress_bound(compressor_.get(), bytes_);
    }

    /// A stream of zlib (RFC 1950). Returns its length; 0: the compressor failed.
    std::size_t pack(const unsigned char* chunk, unsigned char* to) {
        const unsigned char* const all = shuffled(chunk);
        const std::size_t noise = count_of_noise(all) * (bytes_ / width_);
        unsigned char* at = to;
        *at++ = 0x78, *at++ = 0x01;  // deflate with a window of 32 kB, level 1
        for (std::size_t n = 0; n < noise; n += kMostStored) at = store(all + n, std::min(kMostStored, noise - n), at);
        const std::size_t last =
            libdeflate_deflate_compress(compressor_.get(), all + noise, bytes_ - noise, at,
                                        libdeflate_deflate_compress_bound(compressor_.get(), bytes_ - noise));
        if (last == 0) return 0;
        at += last;
        const std::uint32_t sum = libdeflate_adler32(1, all, bytes_);
        for (int shift = 24; shift >= 0; shift -= 8) *at++ = static_cast<unsigned char>(sum >> shift);
        return static_cast<std::size_t>(at - to);
    }

private:
    static constexpr std::size_t kMostStored = 65535;  // of one block
    static constexpr std::size_t kPieces = 8, kPiece = 128;

    const unsigned char* shuffled(const unsigned char* chunk) {
        if (width_ == 1) return chunk;
        if (width_ == 4) shuffle<4>(chunk, bytes_ / 4, shuffled_.data());
        if (width_ == 8) shuffle<8>(chunk, bytes_ / 8, shuffled_.data());
        return shuffled_.data();
    }

    /// How many of the numbers' lowest bytes are.
    std::size_t count_of_noise(const unsigned char* all) {
        std::size_t low = 0;
        while (low < width_ && is_noise(all + low * (bytes_ / width_))) ++low;
        return low;
    }

    /// By pieces from all over: a grid is empty in most places. What would shrink by less than a tenth is not worth the
    /// time.
    bool is_noise(const unsigned char* bytes) {
        const std::size_t count = bytes_ / width_;
        if (count < kPieces * kPiece) return false;
        for (std::size_t k = 0; k < kPieces; ++k)
            std::memcpy(sample_.data() + k * kPiece, bytes + k * (count - kPiece) / (kPieces - 1), kPiece);
        return libdeflate_deflate_compress(compressor_.get(), sample_.data(), sample_.size(), shrunk_.data(),
                                           shrunk_.size()) == 0;
    }

    static unsigned char* store(const unsigned char* from, std::size_t count, unsigned char* to) {
        const auto length = static_cast<std::uint16_t>(count), opposite = static_cast<std::uint16_t>(~length);
        *to++ = 0;  // a stored block, and not the last one
        std::memcpy(to, &length, 2);
        std::memcpy(to + 2, &opposite, 2);
        std::memcpy(to + 4, from, count);
        return to + 4 + count;
    }

    struct Free {
        void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
    };

    std::size_t bytes_, width_;
    Bytes shuffled_;
    std::array<unsigned char, kPieces * kPiece> sample_{};
    std::array<unsigned char, kPieces * kPiece * 9 / 10> shrunk_{};  // no room for what shrinks less
    std::unique_ptr<libdeflate_compressor, Free> compressor_;
};

std::size_t product(const std::vector<hsize_t>& shape) {
    return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

/// The array's bytes in chunks of whole rows. HDF5 has the last one filled up.
class Chunks {
public:
    Chunks(const void* values, std::size_t all, std::size_t bytes)
        : values_(static_cast<const unsigned char*>(values)),
          bytes_(bytes),
          count_((all + bytes - 1) / bytes),
          last_(bytes, 0) {
        const std::size_t before = (count_ - 1) * bytes;
        std::memcpy(last_.data(), values_ + before, all - before);
    }
    std::size_t count() const { return count_; }
    /// What a file has where nothing is written.
    bool is_empty(std::size_t k) const {
        const unsigned char* const chunk = (*this)[k];
        return chunk[0] == 0 && std::memcmp(chunk, chunk + 1, bytes_ - 1) == 0;
    }
    const unsigned char* operator[](std::size_t k) const {
        return k + 1 < count_ ? values_ + k * bytes_ : last_.data();
    }

private:
    const unsigned char* values_;
    std::size_t bytes_, count_;
    std::vector<unsigned char> last_;
};

}  // namespace

void set_packed(const Access& access, hid_t creation, const std::vector<hsize_t>& shape,
                std::size_t bytes_of_a_number) {
    const std::vector<hsize_t> chunk = piece_of(shape, bytes_of_a_number, kChunk);
    access.check(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()));
    access.check(H5Pset_shuffle(creation));
    access.check(H5Pset_deflate(creation, kLevel));
}

void write_packed(const Access& access, hid_t set, const std::vector<hsize_t>& shape, std::size_t bytes_of_a_number,
                  const void* values, int threads) {
    const std::vector<hsize_t> chunk = piece_of(shape, bytes_of_a_number, kChunk);
    const std::size_t bytes = product(chunk) * bytes_of_a_number;
    const Chunks chunks(values, product(shape) * bytes_of_a_number, bytes);
    const std::size_t workers = std::min(static_cast<std::size_t>(std::max(threads, 1)), chunks.count());
    const std::size_t together = std::min(4 * workers, chunks.count());
    std::vector<Packer> packers;
    for (std::size_t n = 0; n < workers; ++n) packers.emplace_back(bytes, bytes_of_a_number);
    std::vector<Bytes> packed;
    for (std::size_t n = 0; n < together; ++n) packed.emplace_back(packers.front().bound());
    std::vector<std::size_t> lengths(together);
    std::vector<hsize_t> place(shape.size(), 0);
    const std::size_t axis = axis_of(shape);
    for (std::size_t first = 0; first < chunks.count(); first += together) {
        const std::size_t end = std::min(first + together, chunks.count());
        std::atomic<std::size_t> next{first}, worker{0};
        on_threads(workers, [&] {
            Packer& packer = packers[worker++];
            for (std::size_t k = next++; k < end; k = next++)
                lengths[k - first] = chunks.is_empty(k) ? kLeftOut : packer.pack(chunks[k], packed[k - first].data());
        });
        for (std::size_t k = first; k < end; ++k, place[axis] += chunk[axis]) {
            const std::size_t length = lengths[k - first];
            if (length == kLeftOut) continue;
            expect(length > 0, "a compressor fills no more than its bound");
            access.check(H5Dwrite_chunk(set, H5P_DEFAULT, 0, place.data(), length, packed[k - first].data()));
        }
    }
}

}  // namespace frana::hdf5
