//! Locks: who may act, who waits, who is told what.

use hertzscope::hislip::MessageType;

use super::partner::{Client, Lab, identifier};

const EXCLUSIVE: &[u8] = b"";

fn request(lab: &mut Lab, client: Client, key: &[u8], milliseconds: u32) {
    lab.send(client.asynchronous, MessageType::AsyncLock, (1, milliseconds), key);
}

fn release(lab: &mut Lab, client: Client, after: u32) {
    lab.send(client.asynchronous, MessageType::AsyncLock, (0, after), b"");
}

/// The answer to a request or release: 0 failed, 1 granted or released, 2 shared lock released, 3
/// an error.
#[track_caller]
fn answer(lab: &mut Lab, client: Client) -> u8 {
    let (kind, control, parameter, payload) = lab.next(client.asynchronous);
    assert_eq!((kind, parameter, payload), (MessageType::AsyncLockResponse, 0, Vec::new()));
    control
}

/// Whether there is an exclusive lock, and how many sessions have one of either kind.
fn info(lab: &mut Lab, client: Client) -> (u8, u32) {
    lab.send(client.asynchronous, MessageType::AsyncLockInfo, (0, 0), b"");
    let (kind, control, parameter, _) = lab.next(client.asynchronous);
    assert_eq!(kind, MessageType::AsyncLockInfoResponse);
    (control, parameter)
}

#[test]
fn an_exclusive_lock_holds_the_others_back() {
    let mut lab = Lab::default();
    let (one, two) = (lab.client(), lab.client());
    assert_eq!(info(&mut lab, two), (0, 0));
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, one), 1);
    assert_eq!(info(&mut lab, two), (1, 1));
    request(&mut lab, two, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, two), 0);
    lab.say(two, 0, false, "two?");
    lab.say(one, 0, false, "one?");
    assert_eq!(lab.next(one.synchronous).3, b"one\n");
    assert_eq!(lab.try_next(two.synchronous), None);
    release(&mut lab, one, identifier(0));
    assert_eq!(answer(&mut lab, one), 1);
    assert_eq!(lab.next(two.synchronous).3, b"two\n");
    // Nothing to give back, and nothing twice.
    release(&mut lab, one, identifier(0));
    assert_eq!(answer(&mut lab, one), 3);
    request(&mut lab, one, EXCLUSIVE, 0);
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!((answer(&mut lab, one), answer(&mut lab, one)), (1, 3));
}

#[test]
fn a_shared_lock_is_for_all_with_the_key() {
    let mut lab = Lab::default();
    let (one, two, three) = (lab.client(), lab.client(), lab.client());
    request(&mut lab, one, b"key", 0);
    request(&mut lab, two, b"key", 0);
    request(&mut lab, three, b"other", 0);
    assert_eq!((answer(&mut lab, one), answer(&mut lab, two), answer(&mut lab, three)), (1, 1, 0));
    assert_eq!(info(&mut lab, three), (0, 2));
    lab.say(two, 0, false, "two?");
    assert_eq!(lab.next(two.synchronous).3, b"two\n");
    lab.say(three, 0, false, "three?");
    // One who shares may lock the others out; then both locks are given back, the exclusive one
    // first.
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, one), 1);
    assert_eq!(info(&mut lab, three), (1, 2));
    lab.say(two, 1, true, "again?");
    for code in [1, 2] {
        release(&mut lab, one, 0xFFFF_FEFE);
        assert_eq!(answer(&mut lab, one), code);
    }
    assert_eq!(lab.next(two.synchronous).3, b"again\n");
    // A session that is gone shares nothing.
    lab.network.close(two.synchronous);
    assert_eq!(lab.next(three.synchronous).3, b"three\n");
    request(&mut lab, three, &[b'k'; 257], 0);
    assert_eq!(answer(&mut lab, three), 3);
}

/// A request waits as long as it says, and is granted when the lock is free.
#[test]
fn requests_wait_for_their_time() {
    let mut lab = Lab::default();
    let (one, two, three) = (lab.client(), lab.client(), lab.client());
    lab.wait_until(10.0);
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, one), 1);
    request(&mut lab, two, EXCLUSIVE, 1500);
    request(&mut lab, three, EXCLUSIVE, 5000);
    lab.wait_until(11.49);
    assert_eq!(lab.try_next(two.asynchronous), None);
    lab.wait_until(11.51);
    assert_eq!(answer(&mut lab, two), 0);
    release(&mut lab, one, 0);
    assert_eq!((answer(&mut lab, one), answer(&mut lab, three)), (1, 1));
}

/// A release that overtakes the message sent before it on the other connection waits for it, but
/// not for ever.
#[test]
fn a_release_does_not_overtake_a_message() {
    let mut lab = Lab::default();
    let (one, two) = (lab.client(), lab.client());
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, one), 1);
    lab.say(two, 0, false, "two");
    lab.say(one, 0, false, "one");
    release(&mut lab, one, identifier(1));
    assert_eq!(lab.try_next(one.asynchronous), None);
    lab.say(one, 1, false, "one again");
    assert_eq!(answer(&mut lab, one), 1);
    assert_eq!(lab.fake().log[2..], ["1: one", "1: one again", "2: two"]);
    request(&mut lab, one, EXCLUSIVE, 0);
    release(&mut lab, one, identifier(9));
    assert_eq!(answer(&mut lab, one), 1);
    lab.wait_until(0.9);
    assert_eq!(lab.try_next(one.asynchronous), None);
    lab.wait_until(1.1);
    assert_eq!(answer(&mut lab, one), 1);
}

/// A session that ends gives back all its locks, the shared one as well.
#[test]
fn a_session_that_ends_leaves_no_lock() {
    let mut lab = Lab::default();
    let (one, two) = (lab.client(), lab.client());
    request(&mut lab, one, b"key", 0);
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!((answer(&mut lab, one), answer(&mut lab, one)), (1, 1));
    lab.network.close(one.synchronous);
    request(&mut lab, two, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, two), 1);
    assert_eq!(info(&mut lab, two), (1, 1));
}

/// After a device clear identifiers begin anew: a release that overtakes the first message waits
/// for it.
#[test]
fn identifiers_begin_anew_after_a_device_clear() {
    let mut lab = Lab::default();
    let one = lab.client();
    lab.say(one, 0, false, "before");
    lab.send(one.asynchronous, MessageType::AsyncDeviceClear, (0, 0), b"");
    assert_eq!(lab.next(one.asynchronous).0, MessageType::AsyncDeviceClearAcknowledge);
    lab.send(one.synchronous, MessageType::DeviceClearComplete, (0, 0), b"");
    assert_eq!(lab.next(one.synchronous).0, MessageType::DeviceClearAcknowledge);
    request(&mut lab, one, EXCLUSIVE, 0);
    assert_eq!(answer(&mut lab, one), 1);
    release(&mut lab, one, identifier(0));
    assert_eq!(lab.try_next(one.asynchronous), None, "the first message is still to come");
    lab.say(one, 0, false, "after");
    assert_eq!(answer(&mut lab, one), 1);
}

/// A device clear gets through whoever has the lock, and empties what waits.
#[test]
fn a_device_clear_needs_no_lock() {
    let mut lab = Lab::default();
    let (one, two) = (lab.client(), lab.client());
    request(&mut lab, one, EXCLUSIVE, 0);
    lab.say(two, 0, false, "two?");
    lab.send(two.asynchronous, MessageType::AsyncDeviceClear, (0, 0), b"");
    assert_eq!(lab.next(two.asynchronous).0, MessageType::AsyncDeviceClearAcknowledge);
    lab.send(two.synchronous, MessageType::DeviceClearComplete, (0, 0), b"");
    assert_eq!(lab.next(two.synchronous).0, MessageType::DeviceClearAcknowledge);
    release(&mut lab, one, 0);
    assert_eq!(lab.try_next(two.synchronous), None);
    assert_eq!(lab.fake().log[2..], ["2 cleared"]);
}
