#include "brink/pictures.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "brink/disparity.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

// OpenCV reads this once, before its first OpenEXR picture.
const int kOpenExrIsOn = ::setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);

cv::Mat noise(int type, cv::Size size = {37, 23}) {
  cv::Mat picture(size, type);
  cv::theRNG().state = 7;
  cv::randu(picture, cv::Scalar::all(0), cv::Scalar::all(255));
  return picture;
}

std::string encoded(const std::string& extension, const cv::Mat& picture, const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  cv::imencode(extension, picture, bytes, options);
  return {bytes.begin(), bytes.end()};
}

cv::Mat read(const std::string& bytes) {
  const test::TemporaryFolder folder;
  return read_picture(folder.add("picture", bytes));
}

std::string fault(const std::string& bytes) {
  return test::error_of<std::runtime_error>([&] { read(bytes); });
}

TEST(ReadPicture, ReadsGreyAndColourPng) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat picture = noise(type);
    const cv::Mat again = read(encoded(".png", picture));
    ASSERT_EQ(again.type(), type);
    EXPECT_EQ(cv::norm(again, picture, cv::NORM_INF), 0.0);
  }
}

TEST(ReadPicture, ReadsGreyColourAndProgressiveJpeg) {
  const cv::Mat flat(23, 37, CV_8UC1, cv::Scalar(90));
  EXPECT_LE(cv::norm(read(encoded(".jpg", flat)), flat, cv::NORM_INF), 2.0);
  EXPECT_EQ(read(encoded(".jpg", noise(CV_8UC3))).type(), CV_8UC3);
  const cv::Mat progressive =
      read(encoded(".jpg", noise(CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2}));
  EXPECT_EQ(progressive.size(), cv::Size(37, 23));
}

TEST(ReadPicture, ReadsASinglePixel) { EXPECT_EQ(read(encoded(".png", noise(CV_8UC1, {1, 1}))).size(), cv::Size(1, 1)); }

TEST(ReadPicture, RefusesEveryTruncatedPng) {
  const std::string whole = encoded(".png", noise(CV_8UC1));
  for (std::size_t length = 8; length < whole.size(); ++length) {
    test::expect_line_with(fault(whole.substr(0, length)), "is a truncated PNG picture");
  }
}

TEST(ReadPicture, RefusesEveryTruncatedJpeg) {
  const std::string whole = encoded(".jpg", noise(CV_8UC3));
  for (std::size_t length = 3; length < whole.size(); ++length) {
    test::expect_line_with(fault(whole.substr(0, length)), "is a truncated JPEG picture");
  }
}

TEST(ReadPicture, RefusesDamagedPictures) {
  std::string png = encoded(".png", noise(CV_8UC1));
  png[png.size() / 2] = static_cast<char>(png[png.size() / 2] ^ 1);
  test::expect_line_with(fault(png), "is a damaged PNG picture: wrong check sum");
  test::expect_line_with(fault(png.substr(0, 8) + png.substr(png.size() - 12)), "is damaged: 0x0 px");  // nothing but IEND
  std::string jpeg = encoded(".jpg", noise(CV_8UC1));
  jpeg[2 + 2 + 16] = 'x';  // the marker after the first segment, which is 16 bytes long
  test::expect_line_with(fault(jpeg), "is a damaged JPEG picture");
}

// Decoders go by the first header, the check must not go by another one.
TEST(ReadPicture, RefusesASecondHeader) {
  const std::string png = encoded(".png", noise(CV_8UC1));
  constexpr std::size_t kHeaderEnd = 8 + 25;
  test::expect_line_with(fault(png.substr(0, kHeaderEnd) + png.substr(8)), "its header is not the first part");
  const std::string jpeg = encoded(".jpg", noise(CV_8UC1));
  const std::size_t frame = jpeg.find("\xff\xc0");
  const std::size_t length = 2 + 256 * static_cast<uchar>(jpeg[frame + 2]) + static_cast<uchar>(jpeg[frame + 3]);
  test::expect_line_with(fault(jpeg.substr(0, frame + length) + jpeg.substr(frame)), "is a damaged JPEG picture: two headers");
}

TEST(ReadPicture, RefusesHugePicturesBeforeDecodingThem) {
  const std::string huge = encoded(".png", cv::Mat1b(10000, 10000, uchar{0}));
  EXPECT_LT(huge.size(), 1'000'000U);
  test::expect_line_with(fault(huge), "is a picture of 10000x10000 px, expected at most 64 megapixels");
}

TEST(ReadPicture, RefusesWhatCannotBeMatched) {
  test::expect_line_with(fault(encoded(".png", noise(CV_16UC1))), "is a 16-bit picture, expected 8-bit");
  test::expect_line_with(fault(encoded(".png", noise(CV_8UC4))), "has 4 channels, expected 1 (grey) or 3 (colour)");
  test::expect_line_with(fault(""), "is empty, expected a PNG or JPEG picture");
  test::expect_line_with(fault("hello"), "is not a PNG or JPEG picture");
  test::expect_line_with(fault(encoded(".bmp", noise(CV_8UC3))), "is not a PNG or JPEG picture");
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_picture("/nowhere.png"); }),
                         "/nowhere.png: no such file");
}

TEST(EncodeDisparity, WritesPngAs256thsWithZeroForNone) {
  const cv::Mat1f disparity = (cv::Mat1f(1, 4) << kInvalidDisparity, 0.0F, 1.5F, 255.99F);
  const std::string bytes = encode_disparity(disparity, DisparityFormat::png);
  const cv::Mat1w stored = cv::imdecode(std::vector<uchar>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(std::vector<std::uint16_t>(stored.begin(), stored.end()), (std::vector<std::uint16_t>{0, 1, 384, 65533}));
}

TEST(EncodeDisparity, RefusesAPngThatCannotHoldTheDisparity) {
  const cv::Mat1f disparity = (cv::Mat1f(1, 2) << 1.0F, 256.0F);
  const auto encode = [&disparity] { encode_disparity(disparity, DisparityFormat::png); };
  test::expect_line_with(test::error_of<std::runtime_error>(encode),
                         "disparity at (1, 0) = 256 px, a PNG holds at most 255.99: use .pfm");
}

TEST(EncodeDisparity, WritesPfmAsFloatWithInfinityForNone) {
  const cv::Mat1f disparity = (cv::Mat1f(2, 2) << kInvalidDisparity, 0.0F, 1.5F, 300.25F);
  const std::string bytes = encode_disparity(disparity, DisparityFormat::pfm);
  EXPECT_EQ(bytes.substr(0, 3), "Pf\n");
  const cv::Mat1f stored = cv::imdecode(std::vector<uchar>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
  EXPECT_TRUE(std::isinf(stored(0, 0)));
  EXPECT_EQ(stored(0, 1), 0.0F);
  EXPECT_EQ(stored(1, 0), 1.5F);
  EXPECT_EQ(stored(1, 1), 300.25F);
}

TEST(EncodeDisparity, RefusesAnEmptyImage) {
  EXPECT_THROW(encode_disparity(cv::Mat1f(), DisparityFormat::pfm), std::runtime_error);
}

cv::Mat1f reread(const cv::Mat1f& disparity, const std::string& name) {
  const test::TemporaryFolder folder;
  return read_disparity(folder.add(name, encode_disparity(disparity, disparity_format(name))));
}

std::string disparity_fault(const std::string& name, const std::string& bytes) {
  const test::TemporaryFolder folder;
  return test::error_of<std::runtime_error>([&] { read_disparity(folder.add(name, bytes)); });
}

TEST(ReadDisparity, ReadsPngAsItWasWritten) {
  const cv::Mat1f disparity = (cv::Mat1f(2, 3) << kInvalidDisparity, 0.25F, 1.5F, 255.5F, kInvalidDisparity, 7.0F);
  EXPECT_EQ(cv::norm(reread(disparity, "d.png"), disparity, cv::NORM_INF), 0.0);
}

TEST(ReadDisparity, ReadsPfmAsItWasWritten) {
  const cv::Mat1f disparity = (cv::Mat1f(3, 2) << kInvalidDisparity, 0.0F, 1.2345F, 300.5F, kInvalidDisparity, 7.0F);
  EXPECT_EQ(cv::norm(reread(disparity, "d.pfm"), disparity, cv::NORM_INF), 0.0);
  EXPECT_EQ(reread(cv::Mat1f(1, 1, 4.0F), "d.pfm")(0, 0), 4.0F);
}

TEST(ReadDisparity, ReadsPfmOfTheOtherByteOrder) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("d.pfm", std::string("Pf\n2 1\n1.0\n") + std::string("\x3f\xc0\0\0\x7f\xc0\0\0", 8));
  const cv::Mat1f disparity = read_disparity(path);  // 1.5 and NaN, the greatest byte first
  EXPECT_EQ(disparity(0, 0), 1.5F);
  EXPECT_EQ(disparity(0, 1), kInvalidDisparity);
}

TEST(ReadDisparity, RefusesWhatIsNoDisparityImage) {
  test::expect_line_with(disparity_fault("d.png", encoded(".png", noise(CV_8UC1))), "d.png: is a 8-bit picture of 1 channels");
  test::expect_line_with(disparity_fault("d.png", encoded(".png", noise(CV_16UC3))),
                         "d.png: is a 16-bit picture of 3 channels");
  test::expect_line_with(disparity_fault("d.pfm", "PF\n1 1\n-1\n0000"), "d.pfm: is no grey PFM picture");
  test::expect_line_with(disparity_fault("d.pfm", ""), "d.pfm: is empty, expected a PNG, TIFF, PFM or OpenEXR picture");
  test::expect_line_with(disparity_fault("d.pfm", "hello"), "d.pfm: is no PNG, TIFF, PFM or OpenEXR picture");
  test::expect_line_with(disparity_fault("d.tif", encoded(".tif", noise(CV_8UC1))), "d.tif: holds numbers of kind CV_8U");
  test::expect_line_with(disparity_fault("d.tif", encoded(".tif", noise(CV_64FC1))), "d.tif: holds numbers of kind CV_64F");
  test::expect_line_with(disparity_fault("d.tif", encoded(".tif", noise(CV_16UC3))), "d.tif: has 3 different channels");
  for (const std::string header : {"Pf", "Pf\n0 1\n-1\n", "Pf\n1 1\n0\n", "Pf\n1 -1\n-1\n", "Pf\nx"}) {
    test::expect_line_with(disparity_fault("d.pfm", header),
                           "d.pfm: is no grey PFM picture, expected Pf, columns, rows, scale");
  }
  EXPECT_THROW(read_disparity("/no/such/file.png"), std::runtime_error);
}

TEST(ReadDisparity, RefusesTruncatedFiles) {
  for (const std::string name : {"d.png", "d.pfm"}) {
    const std::string bytes = encode_disparity(cv::Mat1f(2, 2, 3.0F), disparity_format(name));
    test::expect_line_with(disparity_fault(name, bytes.substr(0, bytes.size() - 1)), "is a truncated");
  }
  for (const std::string header : {"Pf\n1 1\n-1", "Pf\n1 1\n-1\n", "Pf\n1000000000 1000000000\n-1\nabcd"}) {
    test::expect_line_with(disparity_fault("d.pfm", header), "d.pfm: is a truncated PFM picture");
  }
}

/// All the kinds of files that hold floats.
const std::vector<std::string> kFloatFiles = {".tiff", ".pfm", ".exr"};

TEST(ReadDisparity, ReadsFloatFilesInPixels) {
  const float infinity = std::numeric_limits<float>::infinity();
  cv::Mat1f stored(5, 7, 3.25F);
  stored(0, 0) = 1.5F;  // upright: the first number of the file is its last row in PFM
  stored(4, 6) = 300.75F;
  stored(2, 0) = 0.0F;
  stored(2, 1) = -3.0F;
  stored(2, 2) = std::numeric_limits<float>::quiet_NaN();
  stored(2, 3) = infinity;
  stored(2, 4) = -infinity;
  const test::TemporaryFolder folder;
  for (const std::string& extension : kFloatFiles) {
    SCOPED_TRACE(extension);
    const cv::Mat1f disparity = read_disparity(folder.add("d" + extension, encoded(extension, stored)));
    ASSERT_EQ(disparity.size(), cv::Size(7, 5));
    EXPECT_EQ(disparity(0, 0), 1.5F);
    EXPECT_EQ(disparity(4, 6), 300.75F);
    EXPECT_EQ(disparity(2, 0), 0.0F);
    for (int u = 1; u <= 4; ++u) EXPECT_EQ(disparity(2, u), kInvalidDisparity) << u;
    EXPECT_EQ(disparity(2, 5), 3.25F);
  }
}

TEST(ReadDisparity, TurnsAPfmMadeByHandUpright) {
  // Two rows of one pixel: 2 below, 1 above. The file begins with the bottom row.
  const std::string bytes = std::string("Pf\n1 2\n-1\n") + std::string("\0\0\0\x40\0\0\x80\x3f", 8);
  const test::TemporaryFolder folder;
  const cv::Mat1f disparity = read_disparity(folder.add("d.pfm", bytes));
  EXPECT_EQ(disparity(0, 0), 1.0F);
  EXPECT_EQ(disparity(1, 0), 2.0F);
}

TEST(ReadDisparity, TakesTheFirstOfThreeEqualChannels) {
  const cv::Mat1f one = (cv::Mat1f(2, 3) << 1.0F, 2.0F, 3.5F, 4.0F, std::numeric_limits<float>::quiet_NaN(), 6.0F);
  cv::Mat three;
  cv::merge(std::vector<cv::Mat>(3, one), three);
  const std::vector<int> exactly = {cv::IMWRITE_TIFF_COMPRESSION, 1};  // by itself OpenCV stores colours of float as it likes
  const test::TemporaryFolder folder;
  for (const std::string extension : {".tiff", ".exr"}) {
    SCOPED_TRACE(extension);
    const cv::Mat1f disparity = read_disparity(folder.add("d" + extension, encoded(extension, three, exactly)));
    EXPECT_EQ(disparity(0, 2), 3.5F);
    EXPECT_EQ(disparity(1, 1), kInvalidDisparity);
    cv::Mat other = three.clone();
    other.at<cv::Vec3f>(1, 2)[1] = 6.5F;
    test::expect_line_with(disparity_fault("e" + extension, encoded(extension, other, exactly)), "has 3 different channels");
  }
}

TEST(ReadDisparity, RefusesEveryTruncatedFloatFile) {
  for (const std::string& extension : kFloatFiles) {
    SCOPED_TRACE(extension);
    const std::string whole = encoded(extension, cv::Mat1f(3, 4, 2.5F));
    // A TIFF ends with four bytes that tell where its next picture is: nothing of this one.
    const std::size_t needed = extension == ".tiff" ? whole.size() - 4 : whole.size();
    for (std::size_t length = 0; length < needed; ++length) {
      EXPECT_NE(disparity_fault("d" + extension, whole.substr(0, length)), "") << length << " of " << whole.size();
    }
  }
}

TEST(ReadDepth, IsMillimetresIn16BitAndMetresInFloat) {
  const test::TemporaryFolder folder;
  const cv::Mat1w millimetres = (cv::Mat1w(2, 2) << 0, 1, 1500, 65535);
  for (const std::string extension : {".png", ".tiff"}) {
    SCOPED_TRACE(extension);
    const cv::Mat1f depth = read_depth(folder.add("d" + extension, encoded(extension, millimetres)));
    EXPECT_EQ(depth(0, 0), 0.0F) << "none";
    EXPECT_FLOAT_EQ(depth(0, 1), 0.001F);
    EXPECT_FLOAT_EQ(depth(1, 0), 1.5F);
    EXPECT_FLOAT_EQ(depth(1, 1), 65.535F);
  }
  const cv::Mat1f metres = (cv::Mat1f(1, 3) << 1.5F, std::numeric_limits<float>::infinity(), -1.0F);
  for (const std::string& extension : kFloatFiles) {
    SCOPED_TRACE(extension);
    const cv::Mat1f depth = read_depth(folder.add("f" + extension, encoded(extension, metres)));
    EXPECT_EQ(depth(0, 0), 1.5F);
    EXPECT_EQ(depth(0, 1), 0.0F);
    EXPECT_EQ(depth(0, 2), 0.0F);
  }
}

TEST(ReadDisparity, TakesA16BitTiffAs256ths) {
  const cv::Mat1w stored = (cv::Mat1w(1, 3) << 0, 256, 640);
  const test::TemporaryFolder folder;
  const cv::Mat1f disparity = read_disparity(folder.add("d.tif", encoded(".tif", stored)));
  EXPECT_EQ(disparity(0, 0), kInvalidDisparity);
  EXPECT_EQ(disparity(0, 1), 1.0F);
  EXPECT_EQ(disparity(0, 2), 2.5F);
}

TEST(ReadPicture, SaysWhatToDoWithDisparitiesAndDepths) {
  for (const std::string& extension : kFloatFiles) {
    test::expect_line_with(fault(encoded(extension, cv::Mat1f(3, 4, 2.5F))),
                           "is a TIFF, PFM or OpenEXR picture, expected PNG or JPEG: disparities and depths must be told");
  }
  test::expect_line_with(fault(encoded(".png", noise(CV_16UC1))), "(--as disparity|depth)");
}

TEST(IsDepthName, TakesPngTiffPfmAndOpenExr) {
  for (const char* name : {"a.png", "a.TIF", "b/a.tiff", "a.pfm", "a.exr"}) EXPECT_TRUE(is_depth_name(name)) << name;
  for (const char* name : {"a.jpg", "a", "exr", "a.txt"}) EXPECT_FALSE(is_depth_name(name)) << name;
}

TEST(DisparityFormat, IsToldByTheExtension) {
  EXPECT_EQ(disparity_format("a/b.PNG"), DisparityFormat::png);
  EXPECT_EQ(disparity_format("b.pfm"), DisparityFormat::pfm);
  test::expect_line_with(test::error_of<std::invalid_argument>([] { disparity_format("b.tiff"); }),
                         "b.tiff: extension \".tiff\", expected .png or .pfm");
}

}  // namespace
}  // namespace brink
