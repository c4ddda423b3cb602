//! Sessions: beginning, messages and replies, interruption, device clear, status, errors.

use hertzscope::hislip::MessageType;
use proptest::prelude::*;

use super::partner::{Client, Lab, identifier};

#[test]
fn a_reply_carries_its_messages_identifier() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.send(client.synchronous, MessageType::Data, (0, identifier(0)), b"he");
    lab.send(client.synchronous, MessageType::DataEnd, (0, identifier(1)), b"llo?");
    let reply = (MessageType::DataEnd, 0, identifier(1), b"hello\n".to_vec());
    assert_eq!(lab.next(client.synchronous), reply);
    assert_eq!(lab.fake().log, ["open 1", "1: hello?"]);
}

#[test]
fn sessions_stand_beside_each_other() {
    let mut lab = Lab::default();
    let (one, two) = (lab.client(), lab.client());
    assert_ne!(one.session, two.session);
    lab.say(one, 0, false, "one?");
    lab.say(two, 0, false, "two?");
    assert_eq!(lab.next(two.synchronous).3, b"two\n");
    assert_eq!(lab.next(one.synchronous).3, b"one\n");
    // One connection less is none.
    lab.network.close(one.asynchronous);
    assert!(lab.is_closed(one.synchronous) && !lab.is_closed(two.synchronous));
    assert_eq!(lab.fake().log.last().expect("a line"), "close 1");
}

/// Replies are cut to what the client takes, header included.
#[test]
fn the_largest_message_is_agreed_on() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.send(
        client.asynchronous,
        MessageType::AsyncMaximumMessageSize,
        (0, 0),
        &100_u64.to_be_bytes(),
    );
    let (kind, _, _, payload) = lab.next(client.asynchronous);
    assert_eq!(kind, MessageType::AsyncMaximumMessageSizeResponse);
    assert_eq!(payload, 65536_u64.to_be_bytes());
    lab.say(client, 0, false, &format!("{}?", "x".repeat(200)));
    let parts: Vec<(MessageType, usize)> = (0..3)
        .map(|_| {
            let (kind, _, parameter, payload) = lab.next(client.synchronous);
            assert_eq!(parameter, identifier(0));
            (kind, payload.len())
        })
        .collect();
    assert_eq!(
        parts,
        [(MessageType::Data, 84), (MessageType::Data, 84), (MessageType::DataEnd, 33)]
    );
    lab.send(client.asynchronous, MessageType::AsyncMaximumMessageSize, (0, 0), b"short");
    assert_eq!(lab.next(client.asynchronous).0, MessageType::Error);
}

/// A message before the reply was read throws the reply away, and both connections hear of it.
#[test]
fn an_unread_reply_is_interrupted() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.say(client, 0, false, "first?");
    lab.say(client, 1, false, "second?");
    assert_eq!(lab.next(client.synchronous).3, b"first\n");
    let interrupted = (MessageType::Interrupted, 0, identifier(1), Vec::new());
    assert_eq!(lab.next(client.synchronous), interrupted);
    assert_eq!(lab.next(client.synchronous).3, b"second\n");
    assert_eq!(
        lab.next(client.asynchronous),
        (MessageType::AsyncInterrupted, 0, identifier(1), vec![])
    );
    // Delivered is not interrupted, and neither is a message after one without reply.
    lab.say(client, 2, true, "third");
    lab.say(client, 3, false, "fourth?");
    lab.say(client, 4, true, "fifth");
    assert_eq!(lab.next(client.synchronous).3, b"fourth\n");
    assert_eq!(lab.try_next(client.synchronous), None);
    assert_eq!(lab.fake().log.iter().filter(|line| line.contains("interrupted")).count(), 1);
}

/// So is one that is still to come.
#[test]
fn an_owed_reply_is_interrupted() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.say(client, 0, false, "later?");
    assert_eq!(lab.try_next(client.synchronous), None);
    lab.say(client, 1, false, "now");
    assert_eq!(lab.next(client.synchronous).0, MessageType::Interrupted);
    lab.fake().log.clear();
    lab.say(client, 2, false, "later?");
    lab.fake().reply(client.session, b"at last\n");
    let reply = (MessageType::DataEnd, 0, identifier(2), b"at last\n".to_vec());
    assert_eq!(lab.next(client.synchronous), reply);
}

#[test]
fn a_device_clear_step_by_step() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.say(client, 0, false, "later?");
    lab.send(client.synchronous, MessageType::Data, (0, identifier(1)), b"half a mess");
    lab.send(client.asynchronous, MessageType::AsyncDeviceClear, (0, 0), b"");
    assert_eq!(lab.next(client.asynchronous).0, MessageType::AsyncInterrupted);
    let acknowledged = lab.next(client.asynchronous);
    assert_eq!(acknowledged, (MessageType::AsyncDeviceClearAcknowledge, 0, 0, Vec::new()));
    // What was on its way is thrown away.
    lab.say(client, 2, false, "lost?");
    assert_eq!(lab.fake().log.iter().filter(|line| line.contains("lost")).count(), 0);
    // A client that prefers overlap mode is told that this is synchronised.
    lab.send(client.synchronous, MessageType::DeviceClearComplete, (1, 0), b"");
    let seen: Vec<_> = std::iter::from_fn(|| lab.try_next(client.synchronous)).collect();
    let last = seen.last().expect("an acknowledgement");
    assert_eq!(*last, (MessageType::DeviceClearAcknowledge, 0, 0, Vec::new()));
    // Identifiers begin anew, and nothing of before is left.
    lab.say(client, 0, false, "fresh?");
    let reply = (MessageType::DataEnd, 0, identifier(0), b"fresh\n".to_vec());
    assert_eq!(lab.next(client.synchronous), reply);
    assert_eq!(lab.fake().log.last().expect("a line"), "1: fresh?");
}

fn status(lab: &mut Lab, client: Client, delivered: bool) -> u8 {
    let control = u8::from(delivered);
    lab.send(client.asynchronous, MessageType::AsyncStatusQuery, (control, identifier(0)), b"");
    let (kind, byte, parameter, payload) = lab.next(client.asynchronous);
    assert_eq!((kind, parameter, payload), (MessageType::AsyncStatusResponse, 0, Vec::new()));
    byte
}

/// Bit 4 of the status byte: a reply that the client has not called delivered.
#[test]
fn the_status_byte_tells_of_a_message() {
    let mut lab = Lab::default();
    let client = lab.client();
    assert_eq!(status(&mut lab, client, false), 0);
    lab.say(client, 0, false, "there?");
    assert_eq!(status(&mut lab, client, false), 16);
    assert_eq!(status(&mut lab, client, true), 0);
    assert_eq!(status(&mut lab, client, false), 0);
}

/// Each new reason is told once; reading the status byte answers the request.
#[test]
fn service_is_asked_for_once_a_reason() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.network.set_status(false, 32);
    lab.wait_until(1.0);
    assert_eq!(lab.try_next(client.asynchronous), None);
    lab.network.set_status(true, 32);
    lab.wait_until(2.0);
    lab.wait_until(3.0);
    assert_eq!(
        lab.next(client.asynchronous),
        (MessageType::AsyncServiceRequest, 96, 0, Vec::new())
    );
    assert_eq!(lab.try_next(client.asynchronous), None);
    assert_eq!(status(&mut lab, client, false), 96);
    assert_eq!(status(&mut lab, client, false), 32);
    lab.network.set_status(false, 32);
    lab.wait_until(4.0);
    lab.network.set_status(true, 32);
    lab.wait_until(5.0);
    assert_eq!(lab.next(client.asynchronous).0, MessageType::AsyncServiceRequest);
}

/// Group execute trigger (IEEE 488.2, 6.1.4.2.5): it has its reply, and a message that has begun
/// goes on behind it.
#[test]
fn a_trigger_stands_beside_a_message_and_has_a_reply() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.fake().triggered = b"0;READY\n".to_vec();
    lab.send(client.synchronous, MessageType::Data, (0, identifier(0)), b"hal");
    lab.send(client.synchronous, MessageType::Trigger, (0, identifier(1)), b"");
    let reply = (MessageType::DataEnd, 0, identifier(1), b"0;READY\n".to_vec());
    assert_eq!(lab.next(client.synchronous), reply);
    lab.send(client.synchronous, MessageType::DataEnd, (1, identifier(2)), b"f?");
    let reply = (MessageType::DataEnd, 0, identifier(2), b"half\n".to_vec());
    assert_eq!(lab.next(client.synchronous), reply);
    assert_eq!(lab.fake().log, ["open 1", "1 triggers", "1: half?"]);
    // A trigger before the reply was read throws it away, as a message does.
    lab.send(client.synchronous, MessageType::Trigger, (0, identifier(3)), b"");
    let interrupted = (MessageType::Interrupted, 0, identifier(3), Vec::new());
    assert_eq!(lab.next(client.synchronous), interrupted);
}

#[test]
fn triggers_and_keys() {
    let mut lab = Lab::default();
    let client = lab.client();
    lab.send(client.synchronous, MessageType::Trigger, (0, identifier(0)), b"");
    for (control, line) in
        [(5, "keys true"), (6, "keys false"), (4, "keys true"), (2, "keys false")]
    {
        lab.send(client.asynchronous, MessageType::AsyncRemoteLocalControl, (control, 0), b"");
        let seen = lab.next(client.asynchronous);
        assert_eq!(seen, (MessageType::AsyncRemoteLocalResponse, 0, 0, Vec::new()));
        assert_eq!(lab.fake().log.last().expect("a line"), line);
    }
    lab.send(client.asynchronous, MessageType::AsyncRemoteLocalControl, (7, 0), b"");
    let (kind, code, ..) = lab.next(client.asynchronous);
    assert_eq!((kind, code), (MessageType::Error, 2));
    assert_eq!(lab.fake().log[1], "1 triggers");
}

/// IVI-6.1, tables 14 and 16: what ends a connection, and what does not.
#[test]
fn errors_have_the_standards_codes() {
    let mut lab = Lab::default();
    let fatal = |lab: &mut Lab, connection: usize, code: u8| {
        let (kind, control, parameter, text) = lab.next(connection);
        assert_eq!((kind, control, parameter), (MessageType::FatalError, code, 0));
        assert!(!text.is_empty() && text.is_ascii());
        assert!(lab.is_closed(connection));
    };
    let connection = lab.connection();
    lab.network.send(connection, b"*IDN?\n and more bytes");
    fatal(&mut lab, connection, 1);
    let connection = lab.connection();
    lab.send(connection, MessageType::Initialize, (0, 0x0100_0000), b"inst7");
    fatal(&mut lab, connection, 3);
    let connection = lab.connection();
    lab.send(connection, MessageType::DataEnd, (0, 0), b"*IDN?");
    fatal(&mut lab, connection, 3);
    let connection = lab.connection();
    lab.send(connection, MessageType::AsyncInitialize, (0, 9), b"");
    fatal(&mut lab, connection, 3);
    let connection = lab.connection();
    lab.send(connection, MessageType::Initialize, (0, 0x0100_0000), b"HiSLIP0");
    let _ = lab.next(connection);
    lab.send(connection, MessageType::DataEnd, (0, identifier(0)), b"too early?");
    fatal(&mut lab, connection, 2);
    let client = lab.client();
    for (at, code, error) in
        [(client.synchronous, 26, 1), (client.synchronous, 200, 3), (client.asynchronous, 7, 1)]
    {
        lab.network.send(at, &[b'H', b'S', code, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        let (kind, control, ..) = lab.next(at);
        assert_eq!((kind, control), (MessageType::Error, error), "type {code}");
    }
    let mut long = vec![b'H', b'S', 7, 0, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 1, 0, 1];
    long.extend(vec![b'x'; 65537]);
    lab.network.send(client.synchronous, &long);
    let (kind, control, ..) = lab.next(client.synchronous);
    assert_eq!((kind, control), (MessageType::Error, 4));
    lab.say(client, 1, false, "still there?");
    assert_eq!(lab.next(client.synchronous).3, b"still there\n");
    lab.send(client.synchronous, MessageType::Initialize, (0, 0x0100_0000), b"hislip0");
    fatal(&mut lab, client.synchronous, 3);
    assert!(lab.is_closed(client.asynchronous));
}

proptest! {
    /// Whatever clients send, a well-behaved one beside them is answered.
    #[test]
    fn random_messages_harm_nobody(messages in prop::collection::vec(
        (0_usize..3, 0_u8..30, 0_u8..8, any::<u32>(), prop::collection::vec(any::<u8>(), 0..12)),
        0..60,
    )) {
        let mut lab = Lab::default();
        let bad = lab.client();
        let stray = lab.connection();
        for (at, code, control, parameter, payload) in messages {
            let at = [bad.synchronous, bad.asynchronous, stray][at];
            let mut bytes = vec![b'H', b'S', code, control];
            bytes.extend(parameter.to_be_bytes());
            bytes.extend((payload.len() as u64).to_be_bytes());
            bytes.extend(payload.iter().map(|byte| byte & 0x7F));
            lab.network.send(at, &bytes);
        }
        lab.network.close(bad.synchronous);
        lab.network.close(bad.asynchronous);
        lab.network.close(stray);
        lab.fake().owes = false;
        let good = lab.client();
        lab.say(good, 0, false, "well?");
        let (kind, _, _, payload) = lab.next(good.synchronous);
        prop_assert_eq!(kind, MessageType::DataEnd);
        prop_assert!(payload.ends_with(b"well\n"));
    }
}

/// A connection that does not become a session with both of its connections is closed; whole
/// sessions stay, however long they are silent.
#[test]
fn half_a_session_expires() {
    let mut lab = Lab::default();
    let whole = lab.client();
    let silent = lab.connection();
    let half = lab.connection();
    lab.send(half, MessageType::Initialize, (0, 0x0100_7878), b"hislip0");
    assert_eq!(lab.next(half).0, MessageType::InitializeResponse);
    lab.wait_until(9.0);
    assert!(!lab.is_closed(silent) && !lab.is_closed(half));
    lab.wait_until(11.0);
    assert!(lab.is_closed(silent) && lab.is_closed(half));
    lab.wait_until(1e6);
    assert!(!lab.is_closed(whole.synchronous) && !lab.is_closed(whole.asynchronous));
}
