//! A line over USB (USBTMC, the USB Test and Measurement Class): the device file of Linux's kernel
//! driver, to which each write is a message, and from which each read asks for a part of a reply.
//!
//! A read of the device file blocks until the kernel's own time limit. It happens in a thread, so
//! that Ctrl-C ends the program at once. Reading without a reply on its way would be an error of
//! the instrument: only messages with a question mark have one. Source: Linux,
//! `drivers/usb/class/usbtmc.c`, `Documentation/ABI/stable/sysfs-driver-usb-usbtmc`.

use std::fs::OpenOptions;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;

use super::transport::{POLL_INTERVAL, Transport};

/// Where the kernel tells which device is which.
const SYSTEM: &str = "/sys/class/usbmisc";
/// Bytes that one read asks for; a curve of 2500 points and its preamble fit.
const READ_BYTES: usize = 4096;
/// Linux's error for a device that was unplugged.
const NO_DEVICE: i32 = 19;

/// What identifies an instrument on USB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbIdentity {
    /// Its maker, 0x0699 for Tektronix.
    pub vendor: u16,
    /// Its model.
    pub product: u16,
    /// Its serial number.
    pub serial: String,
}

/// An instrument that Linux has found on USB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbInstrument {
    /// Its device file.
    pub device: PathBuf,
    /// Maker, model and serial number, where the kernel tells them.
    pub identity: Option<UsbIdentity>,
    /// Manufacturer and product, if the kernel's device files name them.
    pub name: String,
}

/// The instruments that the kernel has found.
pub fn instruments() -> Vec<UsbInstrument> {
    instruments_in(Path::new(SYSTEM))
}

fn instruments_in(system: &Path) -> Vec<UsbInstrument> {
    let entries = std::fs::read_dir(system).into_iter().flatten().flatten();
    let mut found: Vec<UsbInstrument> = entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            name.starts_with("usbtmc").then_some(())?;
            // The interface of the class stands below the device.
            let device = entry.path().join("device").join("..");
            let text = |file: &str| {
                let text = std::fs::read_to_string(device.join(file)).ok()?;
                Some(text.trim().to_owned())
            };
            let number = |file| u16::from_str_radix(&text(file)?, 16).ok();
            let identity = number("idVendor").zip(number("idProduct")).map(|(vendor, product)| {
                let serial = text("serial").unwrap_or_default();
                UsbIdentity { vendor, product, serial }
            });
            let device = Path::new("/dev").join(&name);
            let name = [text("manufacturer"), text("product")].into_iter().flatten();
            Some(UsbInstrument { device, identity, name: name.collect::<Vec<_>>().join(" ") })
        })
        .collect();
    found.sort_by(|a, b| a.device.cmp(&b.device));
    found
}

/// The device file of an instrument.
pub(super) fn device_of(wanted: &UsbIdentity) -> io::Result<PathBuf> {
    let found = instruments();
    let is_wanted = |other: &UsbIdentity| {
        (other.vendor, other.product) == (wanted.vendor, wanted.product)
            && (wanted.serial.is_empty() || other.serial == wanted.serial)
    };
    let mut matching = found.iter().filter(|other| other.identity.as_ref().is_some_and(is_wanted));
    match (matching.next(), matching.next()) {
        (Some(only), None) => Ok(only.device.clone()),
        (Some(_), Some(_)) => {
            let text = "several such instruments: give the serial number";
            Err(io::Error::new(ErrorKind::InvalidInput, text))
        }
        (None, _) => {
            let text = "no such instrument on USB: is it on, and its rear port set to `Computer`? `acquire --list` shows what is there";
            Err(io::Error::new(ErrorKind::NotFound, text))
        }
    }
}

/// What is read and written as the kernel's device file is.
trait Device: io::Read + io::Write + Send + 'static {}

impl<T: io::Read + io::Write + Send + 'static> Device for T {}

/// What the thread is to do.
#[derive(Debug)]
enum Job {
    Write(Vec<u8>),
    Read,
}

/// What it has done: the bytes of a reply, or none for a message that was sent.
type Done = io::Result<Option<Vec<u8>>>;

/// An instrument on USB.
#[derive(Debug)]
pub(super) struct UsbLine {
    jobs: Sender<Job>,
    done: Receiver<Done>,
    /// Whether the thread is at work on a message, or on a reply.
    in_flight: Option<bool>,
    /// Whether a reply is on its way.
    is_expected: bool,
    incoming: Vec<u8>,
}

impl UsbLine {
    /// Opens a device file.
    pub(super) fn open(device: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(device);
        let file = file.map_err(|error| match error.kind() {
            ErrorKind::PermissionDenied => io::Error::new(
                ErrorKind::PermissionDenied,
                "no permission: put `SUBSYSTEM==\"usbmisc\", KERNEL==\"usbtmc*\", MODE=\"0660\", GROUP=\"plugdev\"` into /etc/udev/rules.d/60-usbtmc.rules, run `udevadm control --reload` as root, and plug the cable in again",
            ),
            ErrorKind::NotFound => io::Error::new(
                ErrorKind::NotFound,
                "no such device file: is the scope on, its rear port set to `Computer`, and the kernel's module usbtmc loaded? `acquire --list` shows what is there",
            ),
            _ => error,
        })?;
        Ok(Self::over(file))
    }

    fn over(device: impl Device) -> Self {
        let (jobs, to_do) = mpsc::channel();
        let (report, done) = mpsc::channel();
        // Ends when the line is dropped, or at the time limit of the kernel's read.
        thread::spawn(move || work(device, &to_do, &report));
        Self { jobs, done, in_flight: None, is_expected: false, incoming: Vec::new() }
    }

    /// What comes of a job, which is begun if none of its kind is in flight; waits once.
    fn result(&mut self, is_write: bool, job: impl FnOnce() -> Job) -> Done {
        // A read that was given up comes first.
        while self.in_flight.is_some_and(|other| other != is_write) {
            drop(self.wait()?);
        }
        if self.in_flight.is_none() {
            self.jobs.send(job()).map_err(|_| super::transport::connection_closed())?;
            self.in_flight = Some(is_write);
        }
        self.wait()
    }

    fn wait(&mut self) -> Done {
        match self.done.recv_timeout(POLL_INTERVAL) {
            Ok(done) => {
                self.in_flight = None;
                done
            }
            Err(RecvTimeoutError::Timeout) => Err(ErrorKind::TimedOut.into()),
            Err(RecvTimeoutError::Disconnected) => Err(super::transport::connection_closed()),
        }
    }
}

/// Reads and writes a device until the line is dropped.
fn work(mut file: impl Device, jobs: &Receiver<Job>, report: &Sender<Done>) {
    while let Ok(job) = jobs.recv() {
        let done = match job {
            Job::Write(bytes) => file.write_all(&bytes).map(|()| None),
            Job::Read => {
                let mut bytes = vec![0; READ_BYTES];
                file.read(&mut bytes).map(|count| {
                    bytes.truncate(count);
                    Some(bytes)
                })
            }
        };
        let done = done.map_err(|error| match error.raw_os_error() {
            Some(NO_DEVICE) => io::Error::new(ErrorKind::UnexpectedEof, "it was unplugged"),
            _ => error,
        });
        if report.send(done).is_err() {
            return;
        }
    }
}

impl Transport for UsbLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.incoming.is_empty() {
            if !self.is_expected {
                thread::sleep(POLL_INTERVAL);
                return Err(ErrorKind::TimedOut.into());
            }
            self.incoming = self.result(false, || Job::Read)?.unwrap_or_default();
        }
        let count = self.incoming.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(self.incoming.drain(..count)) {
            *place = byte;
        }
        // An empty part of a reply: the next one follows.
        if count == 0 { Err(ErrorKind::TimedOut.into()) } else { Ok(count) }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.result(true, || Job::Write(bytes.to_vec()))?;
        self.incoming.clear();
        self.is_expected = bytes.contains(&b'?');
        Ok(bytes.len())
    }

    fn hint(&self) -> &'static str {
        "the scope takes no bytes over USB: is its rear port set to `Computer`?"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts of replies, time-outs of the kernel, and the end.
    struct Scripted(std::vec::IntoIter<Result<&'static [u8], i32>>);

    impl io::Read for Scripted {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let part = self.0.next().expect("no read without a message");
            let part = part.map_err(io::Error::from_raw_os_error)?;
            buffer[..part.len()].copy_from_slice(part);
            Ok(part.len())
        }
    }

    impl io::Write for Scripted {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// What comes until it fails otherwise than by a time-out, or `count` bytes are there.
    fn received(line: &mut UsbLine, count: usize) -> (Vec<u8>, Option<io::Error>) {
        let (mut bytes, mut buffer) = (Vec::new(), [0; 3]);
        while bytes.len() < count {
            match line.read(&mut buffer) {
                Ok(count) => bytes.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                Err(error) => return (bytes, Some(error)),
            }
        }
        (bytes, None)
    }

    #[test]
    fn short_reads_and_time_outs_are_survived_and_unplugging_is_told() {
        const TIMED_OUT: i32 = 110;
        let parts: Vec<Result<&[u8], i32>> = vec![
            Ok(b"#15"),
            Err(TIMED_OUT),
            Ok(b"a\nb"),
            Ok(b""),
            Ok(b"cd\n"),
            Ok(b"#15"),
            Err(NO_DEVICE),
        ];
        let mut line = UsbLine::over(Scripted(parts.into_iter()));
        // Without a message nothing is read.
        assert_eq!(line.read(&mut [0; 8]).expect_err("nothing").kind(), ErrorKind::TimedOut);
        line.write(b"CURV?\n").expect("taken");
        assert_eq!(received(&mut line, 9).0, b"#15a\nbcd\n");
        line.write(b"CURV?\n").expect("taken");
        let (bytes, error) = received(&mut line, 9);
        assert_eq!(bytes, b"#15");
        assert_eq!(error.expect("gone").to_string(), "it was unplugged");
    }

    #[test]
    fn instruments_are_listed_with_their_identity() {
        let folder = tempfile::tempdir().expect("a folder");
        let interface = folder.path().join("devices/1-2/1-2:1.0");
        std::fs::create_dir_all(&interface).expect("folders");
        let device = folder.path().join("devices/1-2");
        for (file, text) in [
            ("idVendor", "0699\n"),
            ("idProduct", "0363\n"),
            ("serial", "C031611\n"),
            ("manufacturer", "Tektronix\n"),
            ("product", "TDS2014B\n"),
        ] {
            std::fs::write(device.join(file), text).expect("a file");
        }
        let class = folder.path().join("class");
        std::fs::create_dir_all(class.join("usbtmc0")).expect("folders");
        std::fs::create_dir_all(class.join("hiddev0")).expect("folders");
        #[cfg(unix)]
        std::os::unix::fs::symlink(&interface, class.join("usbtmc0/device")).expect("a link");
        #[cfg(unix)]
        assert_eq!(
            instruments_in(&class),
            [UsbInstrument {
                device: PathBuf::from("/dev/usbtmc0"),
                identity: Some(UsbIdentity {
                    vendor: 0x0699,
                    product: 0x0363,
                    serial: "C031611".to_owned()
                }),
                name: "Tektronix TDS2014B".to_owned(),
            }]
        );
        assert_eq!(instruments_in(&folder.path().join("nothing")), []);
    }
}
