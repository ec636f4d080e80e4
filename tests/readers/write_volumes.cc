// Writes the volumes of tests/data/volumes that python3-openvdb can't:
// g++ -std=c++17 write_volumes.cc -lopenvdb -ltbb -lImath-3_1 -o write_volumes && ./write_volumes FOLDER
#include <fstream>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

using namespace openvdb;

// The bump of write_volumes.py.
template <class Grid> typename Grid::Ptr bump() {
    auto grid = Grid::create();
    auto accessor = grid->getAccessor();
    const double size[3] = {20, 12, 9};
    for (int i = 0; i < 20; i++) for (int j = 0; j < 12; j++) for (int k = 0; k < 9; k++) {
        const double p[3] = {double(i), double(j), double(k)};
        double square = 0;
        for (int c = 0; c < 3; c++) square += std::pow((p[c] - (size[c] - 1) / 2) / (size[c] / 2), 2);
        const double value = std::nearbyint(1024 * std::max(0.0, 1 - square)) / 1024;
        if (value > 0) accessor.setValue(Coord(i - 3, j + 5, k + 100), value);
    }
    grid->setName("density");
    grid->setGridClass(GRID_FOG_VOLUME);
    return grid;
}

int main(int, char **words) {
    initialize();
    const std::string folder = words[1];
    const auto write = [&](const char *name, GridBase::Ptr grid, uint32_t compression) {
        io::File file(folder + "/" + name);
        file.setCompression(compression);
        file.write({grid});
        file.close();
    };
    write("zip.vdb", bump<FloatGrid>(), io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
    write("double.vdb", bump<DoubleGrid>(), io::COMPRESS_BLOSC);
    // As pipes have it: no places of grids.
    std::ofstream pipe(folder + "/stream.vdb", std::ios_base::binary);
    io::Stream stream(pipe);
    stream.setCompression(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
    stream.write({bump<FloatGrid>()});
    // Everything as it is, which is long, for age_volume.py to make an old file of.
    write("plain.vdb", bump<FloatGrid>(), io::COMPRESS_NONE);
}
