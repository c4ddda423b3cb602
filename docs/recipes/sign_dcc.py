"""Signs a digital calibration certificate (XAdES, enveloped: the signature becomes the last element, as the schema has it).

    pip install signxml
    python sign_dcc.py CERTIFICATE.xml KEY.pem LABORATORY.pem > SIGNED.xml

KEY.pem is the laboratory's private key, LABORATORY.pem its X.509 certificate. A qualified signature (eIDAS) needs a key from a trust service.
"""

import sys

from lxml import etree
from signxml.xades import XAdESSigner

file, key, certificate = sys.argv[1:]
with open(key, "rb") as secret, open(certificate) as public:
    signed = XAdESSigner().sign(etree.parse(file).getroot(), key=secret.read(), cert=public.read())
sys.stdout.buffer.write(etree.tostring(signed, xml_declaration=True, encoding="UTF-8"))
